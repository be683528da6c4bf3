// SPDX-License-Identifier: MIT
// Bullet in single or double precision, as its headers were told: sequential impulses.
#include <btBulletDynamicsCommon.h>

#include <memory>

#include "peer.h"

namespace {

// Share of a mesh's smallest half extent that Bullet may round it by; its own default is 40 mm.
constexpr double kMeshMargin = 0.01;

const peer::Scene* pair_values = nullptr;  // Bullet asks through free functions

btScalar pair_restitution(const btCollisionObject* a, const btCollisionObject* b) {
  return btScalar(pair_values->restitution[size_t(a->getUserIndex())][size_t(b->getUserIndex())]);
}

btScalar pair_friction(const btCollisionObject* a, const btCollisionObject* b) {
  return btScalar(pair_values->friction[size_t(a->getUserIndex())][size_t(b->getUserIndex())]);
}

btVector3 vector_of(const peer::Vec3& v) {
  return {btScalar(v[0]), btScalar(v[1]), btScalar(v[2])};
}

peer::Vec3 vector_of(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

std::unique_ptr<btCollisionShape> shape_of(const peer::Body& body) {
  if (body.kind == peer::Kind::box)
    return std::make_unique<btBoxShape>(vector_of(body.half_extents));
  if (body.kind == peer::Kind::sphere)
    return std::make_unique<btSphereShape>(btScalar(body.radius));
  if (body.kind == peer::Kind::mesh) {
    auto hull = std::make_unique<btConvexHullShape>();
    double least = HUGE_VAL;
    for (int axis = 0; axis < 3; ++axis) {
      double low = HUGE_VAL, high = -HUGE_VAL;
      for (const auto& corner : body.vertices) {
        low = std::min(low, corner[size_t(axis)]);
        high = std::max(high, corner[size_t(axis)]);
      }
      least = std::min(least, (high - low) / 2);
    }
    hull->setMargin(btScalar(kMeshMargin * least));
    for (const auto& corner : body.vertices) hull->addPoint(vector_of(corner), false);
    hull->recalcLocalAabb();
    return hull;
  }
  auto compound = std::make_unique<btCompoundShape>();
  auto* ball = new btSphereShape(btScalar(body.radius));  // as long-lived as the process
  for (const auto& centre : body.centres)
    compound->addChildShape(btTransform(btQuaternion::getIdentity(), vector_of(centre)), ball);
  return compound;
}

class World {
 public:
  explicit World(const peer::Scene& scene) : dt_(btScalar(scene.dt)) {
    pair_values = &scene;
    gCalculateCombinedRestitutionCallback = pair_restitution;
    gCalculateCombinedFrictionCallback = pair_friction;
    world_.setGravity(vector_of(scene.gravity));
    settings(scene.config);
    for (const peer::Plane& plane : scene.planes)
      add(std::make_unique<btStaticPlaneShape>(vector_of(plane.normal), btScalar(plane.offset)), 0,
          btVector3(0, 0, 0), btTransform::getIdentity(), plane.material);
    first_body_ = bodies_.size();
    for (const peer::Body& body : scene.bodies) {
      const auto& q = body.orientation;
      const btQuaternion turn{btScalar(q[1]), btScalar(q[2]), btScalar(q[3]), btScalar(q[0])};
      btRigidBody& added =
          add(shape_of(body), body.is_free ? btScalar(body.mass) : 0, vector_of(body.inertia),
              btTransform(turn, vector_of(body.position)), body.material);
      if (!body.is_free) continue;
      added.setLinearVelocity(vector_of(body.linear_velocity));
      added.setAngularVelocity(vector_of(body.angular_velocity));
    }
  }

  ~World() {
    for (auto& body : bodies_) world_.removeRigidBody(body.get());
  }

  void step() { world_.stepSimulation(dt_, 0); }

  peer::State state(size_t i) const {
    const btRigidBody& body = *bodies_[first_body_ + i];
    const btTransform& place = body.getWorldTransform();
    const btQuaternion q = place.getRotation();
    return {vector_of(place.getOrigin()),
            {q.w(), q.x(), q.y(), q.z()},
            vector_of(body.getLinearVelocity()),
            vector_of(body.getAngularVelocity())};
  }

  std::string version() const {
    const int version = btGetVersion();
    return std::to_string(version / 100) + "." + std::to_string(version % 100) +
           (sizeof(btScalar) == 8 ? " float64" : " float32");
  }

  std::string failure() const { return ""; }

 private:
  void settings(const std::string& config) {
    btContactSolverInfo& solver = world_.getSolverInfo();
    if (config == "default") return;
    solver.m_restitutionVelocityThreshold = 0;
    if (config == "tuned") {
      solver.m_numIterations = 100;
    } else if (config == "restitution") {
      touching_only_ = true;
      solver.m_solverMode &= ~SOLVER_USE_WARMSTARTING;
      solver.m_linearSlop = 0;
      solver.m_splitImpulse = 1;
      solver.m_splitImpulsePenetrationThreshold = 0;
    } else {
      throw std::runtime_error("bullet has no configuration " + config);
    }
  }

  btRigidBody& add(std::unique_ptr<btCollisionShape> shape, btScalar mass, const btVector3& inertia,
                   const btTransform& place, int material) {
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, shape.get(), inertia);
    info.m_startWorldTransform = place;
    auto body = std::make_unique<btRigidBody>(info);
    body->setUserIndex(material);
    if (mass > 0) body->setActivationState(DISABLE_DEACTIVATION);
    if (touching_only_) body->setContactProcessingThreshold(0);
    world_.addRigidBody(body.get());
    shapes_.push_back(std::move(shape));
    bodies_.push_back(std::move(body));
    return *bodies_.back();
  }

  btScalar dt_;
  bool touching_only_ = false;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broad_phase_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_{&dispatcher_, &broad_phase_, &solver_, &configuration_};
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
  size_t first_body_ = 0;
};

}  // namespace

int main(int argc, char** argv) { return peer::run_main<World>(argc, argv); }
