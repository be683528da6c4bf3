// SPDX-License-Identifier: MIT
// Open Dynamics Engine in double precision: QuickStep, or its direct solver dWorldStep.
#include <ode/ode.h>

#include <csetjmp>
#include <cstdarg>
#include <memory>

#include "peer.h"

namespace {

constexpr int kContactsPerPair = 8;

void say_nothing(int, const char*, va_list) {}

// ODE ends the process where its own promises break: numbers out of range, mostly. It was built
// without exceptions, so the way back to `step` is a jump over plain C data.
std::jmp_buf out_of_step;
char complaint[200];

[[noreturn]] void leave_step(int, const char* text, va_list values) {
  std::vsnprintf(complaint, sizeof complaint, text, values);
  std::longjmp(out_of_step, 1);
}

class World {
 public:
  explicit World(const peer::Scene& scene) : scene_(scene) {
    if (scene.config != "20" && scene.config != "100" && scene.config != "dWorldStep")
      throw std::runtime_error("ode has no configuration " + scene.config);
    dInitODE2(0);
    dRandSetSeed(0);                  // QuickStep takes its constraints in random order
    dSetMessageHandler(say_nothing);  // its LCP solver complains by the hundred thousand
    dSetErrorHandler(leave_step);
    dSetDebugHandler(leave_step);
    complaint[0] = 0;
    world_ = dWorldCreate();
    space_ = dHashSpaceCreate(nullptr);
    contacts_ = dJointGroupCreate(0);
    is_direct_ = scene.config == "dWorldStep";
    dWorldSetGravity(world_, scene.gravity[0], scene.gravity[1], scene.gravity[2]);
    dWorldSetERP(world_, 0.2);
    dWorldSetCFM(world_, is_direct_ ? 0 : 1e-10);
    if (!is_direct_) dWorldSetQuickStepNumIterations(world_, std::stoi(scene.config));
    for (const peer::Plane& plane : scene.planes) {
      const auto& n = plane.normal;
      dGeomSetData(dCreatePlane(space_, n[0], n[1], n[2], plane.offset), tag(plane.material));
    }
    convex_.reserve(scene.bodies.size());
    for (const peer::Body& body : scene.bodies) bodies_.push_back(add(body));
  }

  void step() {
    if (complaint[0] || setjmp(out_of_step)) return;
    dSpaceCollide(space_, this, [](void* self, dGeomID a, dGeomID b) {
      static_cast<World*>(self)->collide(a, b);
    });
    const int done =
        is_direct_ ? dWorldStep(world_, scene_.dt) : dWorldQuickStep(world_, scene_.dt);
    if (done == 0) out_of_memory_ = true;
    dJointGroupEmpty(contacts_);
  }

  peer::State state(size_t i) const {
    const dBodyID body = bodies_[i];
    const dReal* q = dBodyGetQuaternion(body);
    return {vector_of(dBodyGetPosition(body)),
            {q[0], q[1], q[2], q[3]},
            vector_of(dBodyGetLinearVel(body)),
            vector_of(dBodyGetAngularVel(body))};
  }

  std::string version() const {
    return std::string(dODE_VERSION) +
           (dCheckConfiguration("ODE_double_precision") ? " float64" : "");
  }

  std::string failure() const {
    if (complaint[0]) return std::string("ODE gave up: ") + complaint;
    return out_of_memory_ ? "no memory for a step" : "";
  }

 private:
  static peer::Vec3 vector_of(const dReal* v) { return {v[0], v[1], v[2]}; }

  static void* tag(int material) { return reinterpret_cast<void*>(intptr_t{material}); }

  static size_t material_of(dGeomID geom) {
    return static_cast<size_t>(reinterpret_cast<intptr_t>(dGeomGetData(geom)));
  }

  void collide(dGeomID a, dGeomID b) {
    const dBodyID body_a = dGeomGetBody(a), body_b = dGeomGetBody(b);
    if (body_a == body_b) return;  // two fixed ones, or two parts of a body
    dContact contact[kContactsPerPair];
    const int count = dCollide(a, b, kContactsPerPair, &contact[0].geom, sizeof(dContact));
    const size_t i = material_of(a), j = material_of(b);
    for (int k = 0; k < count; ++k) {
      dSurfaceParameters& surface = contact[k].surface;
      surface.mode = dContactApprox1;
      surface.mu = scene_.friction[i][j];
      if (scene_.restitution[i][j] > 0) {
        surface.mode |= dContactBounce;
        surface.bounce = scene_.restitution[i][j];
        surface.bounce_vel = 0;
      }
      dJointAttach(dJointCreateContact(world_, contacts_, &contact[k]), body_a, body_b);
    }
  }

  dBodyID add(const peer::Body& body) {
    dBodyID id = nullptr;
    if (body.is_free) {
      id = dBodyCreate(world_);
      dMass mass;
      const auto& moments = body.inertia;
      dMassSetParameters(&mass, body.mass, 0, 0, 0, moments[0], moments[1], moments[2], 0, 0, 0);
      dBodySetMass(id, &mass);
    }
    const std::vector<dGeomID> geoms = geoms_of(body);
    for (size_t k = 0; k < geoms.size(); ++k) {
      dGeomSetData(geoms[k], tag(body.material));
      dGeomSetBody(geoms[k], id);
      if (!body.is_free) place(geoms[k], body, k);
    }
    if (body.is_free) {
      const auto& x = body.position;
      const auto& q = body.orientation;
      const auto& v = body.linear_velocity;
      const auto& w = body.angular_velocity;
      const dQuaternion turn = {q[0], q[1], q[2], q[3]};
      dBodySetPosition(id, x[0], x[1], x[2]);
      dBodySetQuaternion(id, turn);
      dBodySetLinearVel(id, v[0], v[1], v[2]);
      dBodySetAngularVel(id, w[0], w[1], w[2]);
    }
    if (body.is_free && body.kind == peer::Kind::spheres)
      for (size_t k = 0; k < geoms.size(); ++k) {
        const auto& at = body.centres[k];
        dGeomSetOffsetPosition(geoms[k], at[0], at[1], at[2]);
      }
    return id;
  }

  /// Part k of a fixed body, in the world.
  static void place(dGeomID geom, const peer::Body& body, size_t k) {
    const auto& q = body.orientation;
    const dQuaternion turn = {q[0], q[1], q[2], q[3]};
    dGeomSetQuaternion(geom, turn);
    dVector3 aside = {0, 0, 0};
    if (body.kind == peer::Kind::spheres) {
      dMatrix3 rotation;
      dQtoR(turn, rotation);
      dMultiply0_331(aside, rotation, body.centres[k].data());
    }
    const auto& at = body.position;
    dGeomSetPosition(geom, at[0] + aside[0], at[1] + aside[1], at[2] + aside[2]);
  }

  std::vector<dGeomID> geoms_of(const peer::Body& body) {
    if (body.kind == peer::Kind::box) {
      const auto& half = body.half_extents;
      return {dCreateBox(space_, 2 * half[0], 2 * half[1], 2 * half[2])};
    }
    if (body.kind == peer::Kind::sphere) return {dCreateSphere(space_, body.radius)};
    if (body.kind == peer::Kind::mesh) return {convex(body)};
    std::vector<dGeomID> geoms;
    for (size_t k = 0; k < body.centres.size(); ++k)
      geoms.push_back(dCreateSphere(space_, body.radius));
    return geoms;
  }

  /// ODE keeps pointers to planes, points and polygons: they live as long as the world.
  dGeomID convex(const peer::Body& body) {
    Convex& shape = convex_.emplace_back();
    for (const auto& corner : body.vertices)
      shape.points.insert(shape.points.end(), corner.begin(), corner.end());
    for (const auto& triangle : body.triangles) {
      const auto& a = body.vertices[size_t(triangle[0])];
      const auto& b = body.vertices[size_t(triangle[1])];
      const auto& c = body.vertices[size_t(triangle[2])];
      peer::Vec3 u, v;
      for (size_t k = 0; k < 3; ++k) u[k] = b[k] - a[k], v[k] = c[k] - a[k];
      peer::Vec3 n = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                      u[0] * v[1] - u[1] * v[0]};
      const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
      for (double& value : n) value /= length;
      shape.planes.insert(shape.planes.end(), n.begin(), n.end());
      shape.planes.push_back(n[0] * a[0] + n[1] * a[1] + n[2] * a[2]);
      shape.polygons.push_back(3);
      for (int corner : triangle) shape.polygons.push_back(unsigned(corner));
    }
    return dCreateConvex(space_, shape.planes.data(), unsigned(body.triangles.size()),
                         shape.points.data(), unsigned(body.vertices.size()),
                         shape.polygons.data());
  }

  struct Convex {
    std::vector<dReal> planes, points;
    std::vector<unsigned> polygons;
  };

  const peer::Scene& scene_;
  dWorldID world_;
  dSpaceID space_;
  dJointGroupID contacts_;
  bool is_direct_ = false;
  bool out_of_memory_ = false;
  std::vector<dBodyID> bodies_;
  std::vector<Convex> convex_;
};

}  // namespace

int main(int argc, char** argv) { return peer::run_main<World>(argc, argv); }
