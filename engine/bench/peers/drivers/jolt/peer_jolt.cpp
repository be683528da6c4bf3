// SPDX-License-Identifier: MIT
// Jolt Physics in single precision, one thread. Version 5.0 has no planes: a large box is one.
#include <Jolt/Jolt.h>
// Jolt.h comes first.
#include <Jolt/Core/Factory.h>
#include <Jolt/Core/JobSystemSingleThreaded.h>
#include <Jolt/Core/TempAllocator.h>
#include <Jolt/Physics/Body/BodyCreationSettings.h>
#include <Jolt/Physics/Collision/Shape/BoxShape.h>
#include <Jolt/Physics/Collision/Shape/ConvexHullShape.h>
#include <Jolt/Physics/Collision/Shape/SphereShape.h>
#include <Jolt/Physics/Collision/Shape/StaticCompoundShape.h>
#include <Jolt/Physics/PhysicsSystem.h>
#include <Jolt/RegisterTypes.h>

#include <memory>

#include "../peer.h"

namespace {

constexpr JPH::ObjectLayer kFixed = 0, kFree = 1;
// m; a cube as deep as it is wide loses digits: creep on a slope of 1e-3 mm instead of 2e-5.
constexpr double kGroundDepth = 2;
constexpr JPH::uint kPairsPerBody = 64, kLeastPairs = 4096;
constexpr JPH::uint kBytesPerBody = 64 * 1024, kLeastBytes = 16 * 1024 * 1024;

class TwoLayers final : public JPH::BroadPhaseLayerInterface {
 public:
  JPH::uint GetNumBroadPhaseLayers() const override { return 2; }
  JPH::BroadPhaseLayer GetBroadPhaseLayer(JPH::ObjectLayer layer) const override {
    return JPH::BroadPhaseLayer(static_cast<JPH::uint8>(layer));
  }
};

class FreeMeetsAll final : public JPH::ObjectLayerPairFilter,
                           public JPH::ObjectVsBroadPhaseLayerFilter {
 public:
  bool ShouldCollide(JPH::ObjectLayer a, JPH::ObjectLayer b) const override {
    return a == kFree || b == kFree;
  }
  bool ShouldCollide(JPH::ObjectLayer a, JPH::BroadPhaseLayer b) const override {
    return a == kFree || b == JPH::BroadPhaseLayer(kFree);
  }
};

const peer::Scene* pair_values = nullptr;  // Jolt asks through free functions

float pair_restitution(const JPH::Body& a, const JPH::SubShapeID&, const JPH::Body& b,
                       const JPH::SubShapeID&) {
  return float(pair_values->restitution[a.GetUserData()][b.GetUserData()]);
}

float pair_friction(const JPH::Body& a, const JPH::SubShapeID&, const JPH::Body& b,
                    const JPH::SubShapeID&) {
  return float(pair_values->friction[a.GetUserData()][b.GetUserData()]);
}

JPH::Vec3 vector_of(const peer::Vec3& v) { return {float(v[0]), float(v[1]), float(v[2])}; }

JPH::Quat quaternion_of(const peer::Quat& q) {
  return JPH::Quat(float(q[1]), float(q[2]), float(q[3]), float(q[0])).Normalized();
}

peer::Vec3 vector_of(JPH::Vec3Arg v) { return {v.GetX(), v.GetY(), v.GetZ()}; }

JPH::ShapeRefC made(const JPH::ShapeSettings& settings) {
  const JPH::ShapeSettings::ShapeResult result = settings.Create();
  if (result.HasError()) throw std::runtime_error("jolt: " + std::string(result.GetError()));
  return result.Get();
}

JPH::ShapeRefC shape_of(const peer::Body& body) {
  if (body.kind == peer::Kind::box) {
    const JPH::Vec3 half = vector_of(body.half_extents);
    // Jolt's own rounding of edges, which no half edge may fall below.
    return new JPH::BoxShape(half, std::min(JPH::cDefaultConvexRadius, half.ReduceMin()));
  }
  if (body.kind == peer::Kind::sphere) return new JPH::SphereShape(float(body.radius));
  if (body.kind == peer::Kind::mesh) {
    JPH::Array<JPH::Vec3> corners;
    for (const auto& corner : body.vertices) corners.push_back(vector_of(corner));
    return made(JPH::ConvexHullShapeSettings(corners));
  }
  JPH::StaticCompoundShapeSettings compound;
  const JPH::ShapeRefC ball = new JPH::SphereShape(float(body.radius));
  for (const auto& centre : body.centres)
    compound.AddShape(vector_of(centre), JPH::Quat::sIdentity(), ball);
  return made(compound);
}

/// Half edge of the box that is the ground: far beyond where anything can get in the time.
double reach(const peer::Scene& scene) {
  double far = 10;
  const double duration = scene.dt * scene.steps_per_frame * scene.num_frames;
  double fall = 0;
  for (double g : scene.gravity) fall += std::abs(g) * duration * duration / 2;
  for (const peer::Body& body : scene.bodies)
    for (size_t axis = 0; axis < 3; ++axis)
      far = std::max(
          far, std::abs(body.position[axis]) + std::abs(body.linear_velocity[axis]) * duration);
  return 2 * far + std::min(fall, 50.0);
}

/// What Jolt wants once per process.
struct Library {
  Library() {
    JPH::RegisterDefaultAllocator();
    JPH::Factory::sInstance = new JPH::Factory();
    JPH::RegisterTypes();
  }
};

class World {
 public:
  explicit World(const peer::Scene& scene) : dt_(float(scene.dt)) {
    static const Library library;
    const bool tuned = scene.config == "tuned";
    if (!tuned && scene.config != "default")
      throw std::runtime_error("jolt has no configuration " + scene.config);
    pair_values = &scene;
    const auto num_bodies = JPH::uint(scene.bodies.size() + scene.planes.size());
    const JPH::uint num_pairs = std::max(kLeastPairs, kPairsPerBody * num_bodies);
    memory_ =
        std::make_unique<JPH::TempAllocatorImpl>(std::max(kLeastBytes, kBytesPerBody * num_bodies));
    jobs_.Init(JPH::cMaxPhysicsJobs);
    system_.Init(num_bodies + 1, 0, num_pairs, num_pairs, layers_, filter_, filter_);
    system_.SetGravity(vector_of(scene.gravity));
    system_.SetCombineRestitution(pair_restitution);
    system_.SetCombineFriction(pair_friction);
    if (tuned) {
      JPH::PhysicsSettings settings = system_.GetPhysicsSettings();
      settings.mNumVelocitySteps = 30;
      settings.mNumPositionSteps = 10;
      settings.mPenetrationSlop = 5e-4f;
      settings.mMinVelocityForRestitution = 1e-3f;
      system_.SetPhysicsSettings(settings);
    }
    for (const peer::Plane& plane : scene.planes) add_plane(plane, reach(scene));
    for (const peer::Body& body : scene.bodies) add(body, tuned);
    system_.OptimizeBroadPhase();
  }

  void step() { error_ |= system_.Update(dt_, 1, memory_.get(), &jobs_); }

  peer::State state(size_t i) const {
    const JPH::BodyInterface& all = system_.GetBodyInterfaceNoLock();
    const JPH::Quat q = all.GetRotation(bodies_[i]);
    JPH::Vec3 velocity, spin;
    all.GetLinearAndAngularVelocity(bodies_[i], velocity, spin);
    return {vector_of(JPH::Vec3(all.GetCenterOfMassPosition(bodies_[i]))),
            {q.GetW(), q.GetX(), q.GetY(), q.GetZ()},
            vector_of(velocity),
            vector_of(spin)};
  }

  std::string version() const {
    return std::to_string(JPH_VERSION_MAJOR) + "." + std::to_string(JPH_VERSION_MINOR) + "." +
           std::to_string(JPH_VERSION_PATCH) + " float32";
  }

  std::string failure() const {
    return error_ == JPH::EPhysicsUpdateError::None ? "" : "no memory for contacts";
  }

 private:
  void add_plane(const peer::Plane& plane, double reach) {
    const JPH::Vec3 normal = vector_of(plane.normal);
    const JPH::ShapeRefC block =
        new JPH::BoxShape(JPH::Vec3(float(reach), float(reach), float(kGroundDepth / 2)));
    JPH::BodyCreationSettings settings(
        block, JPH::RVec3(normal * float(plane.offset - kGroundDepth / 2)),
        JPH::Quat::sFromTo(JPH::Vec3::sAxisZ(), normal), JPH::EMotionType::Static, kFixed);
    settings.mUserData = JPH::uint64(plane.material);
    added(settings, JPH::EActivation::DontActivate);
  }

  void add(const peer::Body& body, bool tuned) {
    JPH::BodyCreationSettings settings(
        shape_of(body), JPH::RVec3(vector_of(body.position)), quaternion_of(body.orientation),
        body.is_free ? JPH::EMotionType::Dynamic : JPH::EMotionType::Static,
        body.is_free ? kFree : kFixed);
    settings.mUserData = JPH::uint64(body.material);
    if (body.is_free) {
      settings.mLinearVelocity = vector_of(body.linear_velocity);
      settings.mAngularVelocity = vector_of(body.angular_velocity);
      settings.mAllowSleeping = false;
      settings.mOverrideMassProperties = JPH::EOverrideMassProperties::MassAndInertiaProvided;
      settings.mMassPropertiesOverride.mMass = float(body.mass);
      settings.mMassPropertiesOverride.mInertia = JPH::Mat44::sScale(vector_of(body.inertia));
      if (tuned) {
        settings.mApplyGyroscopicForce = true;
        settings.mLinearDamping = settings.mAngularDamping = 0;
      }
    }
    bodies_.push_back(added(
        settings, body.is_free ? JPH::EActivation::Activate : JPH::EActivation::DontActivate));
  }

  JPH::BodyID added(const JPH::BodyCreationSettings& settings, JPH::EActivation activation) {
    return system_.GetBodyInterface().CreateAndAddBody(settings, activation);
  }

  float dt_;
  JPH::EPhysicsUpdateError error_ = JPH::EPhysicsUpdateError::None;
  TwoLayers layers_;
  FreeMeetsAll filter_;
  std::unique_ptr<JPH::TempAllocatorImpl> memory_;
  JPH::JobSystemSingleThreaded jobs_;
  JPH::PhysicsSystem system_;
  std::vector<JPH::BodyID> bodies_;
};

}  // namespace

int main(int argc, char** argv) { return peer::run_main<World>(argc, argv); }
