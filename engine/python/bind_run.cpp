// SPDX-License-Identifier: MIT
// Simulations in Python: NumPy out, the GIL released while stepping.
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

#include "dem/run.h"
#include "dem/surface_contacts.h"
#include "python/module.h"
#include "scene/build_world.h"

namespace nb = nanobind;

namespace verisim::python {
namespace {

/// Copies values into a new NumPy array of this shape.
nb::object array_of(const std::vector<double>& values, std::initializer_list<std::size_t> shape) {
  auto* data = new std::vector<double>(values);
  nb::capsule owner(data, [](void* p) noexcept { delete static_cast<std::vector<double>*>(p); });
  return nb::cast(nb::ndarray<nb::numpy, double>(data->data(), shape, owner));
}

nb::list list_of(const Eigen::Vector3d& v) {
  nb::list list;
  for (double value : v) list.append(value);
  return list;
}

struct Columns {
  std::vector<double> position, orientation, linear_velocity, angular_velocity;
};

void append(const Eigen::Vector3d& v, std::vector<double>& values) {
  values.insert(values.end(), v.data(), v.data() + 3);
}

Columns columns_of(const dem::PoseLog& log) {
  Columns columns;
  for (const dem::Pose& pose : log.poses) {
    append(pose.position, columns.position);
    const Eigen::Quaterniond& q = pose.orientation;
    columns.orientation.insert(columns.orientation.end(), {q.w(), q.x(), q.y(), q.z()});
    append(pose.linear_velocity, columns.linear_velocity);
    append(pose.angular_velocity, columns.angular_velocity);
  }
  return columns;
}

void set_pose_arrays(nb::object& target, const dem::PoseLog& log) {
  const std::size_t num_times = log.num_times(), num_bodies = log.num_bodies();
  const Columns columns = columns_of(log);
  target.attr("time_s") = array_of(log.times, {num_times});
  target.attr("position_m") = array_of(columns.position, {num_times, num_bodies, 3});
  target.attr("orientation_wxyz") = array_of(columns.orientation, {num_times, num_bodies, 4});
  target.attr("linear_velocity_m_s") =
      array_of(columns.linear_velocity, {num_times, num_bodies, 3});
  target.attr("angular_velocity_rad_s") =
      array_of(columns.angular_velocity, {num_times, num_bodies, 3});
}

/// Positions, orientations, velocities, angular momenta of all bodies in file order.
std::vector<double> final_state(const dem::Bodies& bodies) {
  std::vector<double> values;
  for (const auto& position : bodies.position) append(position, values);
  for (const auto& q : bodies.orientation) {
    values.insert(values.end(), {q.w(), q.x(), q.y(), q.z()});
  }
  for (const auto& velocity : bodies.linear_velocity) append(velocity, values);
  for (const auto& momentum : bodies.angular_momentum) append(momentum, values);
  return values;
}

nb::dict metrics_dict(const dem::Metrics& metrics) {
  nb::dict d;
  d["max_penetration_m"] = metrics.max_penetration_m;
  d["mean_penetration_m"] = metrics.mean_penetration_m;
  d["rms_penetration_m"] = metrics.rms_penetration_m;
  d["max_penetration_rel"] = metrics.max_penetration_rel;
  d["energy_start_j"] = metrics.energy_start_j;
  d["energy_end_j"] = metrics.energy_end_j;
  d["kinetic_energy_j"] = metrics.kinetic_energy_j;
  d["potential_energy_j"] = metrics.potential_energy_j;
  d["elastic_energy_j"] = metrics.elastic_energy_j;
  d["damping_work_j"] = metrics.damping_work_j;
  d["friction_work_j"] = metrics.friction_work_j;
  d["outside_work_j"] = metrics.outside_work_j;
  d["energy_scale_j"] = metrics.energy_scale_j;
  d["energy_residual_rel"] = metrics.energy_residual_rel;
  d["momentum_residual_rel"] = metrics.momentum_residual_rel;
  d["angular_momentum_residual_rel"] = metrics.angular_momentum_residual_rel;
  d["energy_rise_j"] = metrics.energy_rise_j;
  if (metrics.num_samples > 0) {
    d["anchor_creep_m"] = metrics.anchor_creep_m;
    d["implicit_work_j"] = metrics.implicit_work_j;
    d["correction_work_j"] = metrics.correction_work_j;
    d["num_samples"] = metrics.num_samples;
    d["num_steps"] = metrics.work.num_steps;
    d["num_implicit_steps"] = metrics.work.num_implicit_steps;
    d["num_refused_steps"] = metrics.work.num_refused_steps;
    d["num_newton_steps"] = metrics.work.num_newton_steps;
  } else {
    d["num_particles"] = metrics.num_particles;
  }
  d["max_contacts"] = metrics.max_contacts;
  return d;
}

nb::object failure_dict(const std::optional<dem::Failure>& failure) {
  if (!failure) return nb::none();
  nb::dict d;
  d["code"] = failure->code;
  d["body"] = failure->body.empty() ? nb::object(nb::none()) : nb::cast(failure->body);
  d["time_s"] = failure->time;
  d["step"] = failure->step;
  d["message"] = failure->message;
  return d;
}

/// Of the relative velocity against the normal; none where it is not known.
nb::object angle_from_normal(const dem::ContactEvent& event) {
  if (event.sliding_speed < 0) return nb::none();
  return nb::cast(std::atan2(event.sliding_speed, event.speed) * 180 / std::numbers::pi);
}

/// The end of a contact also says how long it was and how fast the bodies came and went.
nb::list event_list(const std::vector<dem::ContactEvent>& events, const dem::World& world) {
  nb::list list;
  std::map<std::tuple<int, int, int>, const dem::ContactEvent*> begins;
  for (const dem::ContactEvent& event : events) {
    nb::dict d;
    const bool is_begin = event.change == dem::ContactChange::kBegin;
    d["kind"] = is_begin ? "contact_begin" : "contact_end";
    d["time_s"] = event.time;
    nb::list pair;
    pair.append(world.names[event.body_a]);
    pair.append(event.plane >= 0 ? world.planes[event.plane].name : world.names[event.body_b]);
    d["bodies"] = pair;
    d["normal_speed_m_s"] = event.speed;
    const dem::ContactEvent*& begin = begins[{event.body_a, event.body_b, event.plane}];
    if (is_begin) {
      begin = &event;
      d["approach_speed_m_s"] = event.speed;
    } else if (begin != nullptr) {
      d["approach_speed_m_s"] = begin->speed;
      d["restitution"] =
          begin->speed > 0 ? nb::cast(event.speed / begin->speed) : nb::object(nb::none());
      d["contact_time_s"] = event.time - begin->time;
      d["approach_angle_deg"] = angle_from_normal(*begin);
      d["rebound_angle_deg"] = angle_from_normal(event);
      begin = nullptr;
    }
    list.append(d);
  }
  return list;
}

nb::list body_list(const dem::World& world) {
  nb::list list;
  for (int i = 0; i < world.bodies.count(); ++i) {
    const dem::Pose pose = dem::pose_of(world, i);
    nb::dict d;
    d["name"] = world.names[i];
    d["mass_kg"] = world.bodies.mass[i];
    d["position_m"] = list_of(pose.position);
    nb::list q;
    for (double value :
         {pose.orientation.w(), pose.orientation.x(), pose.orientation.y(), pose.orientation.z()}) {
      q.append(value);
    }
    d["orientation_wxyz"] = q;
    d["linear_velocity_m_s"] = list_of(pose.linear_velocity);
    d["angular_velocity_rad_s"] = list_of(pose.angular_velocity);
    list.append(d);
  }
  return list;
}

nb::dict parameters_dict(const scene::Scene& scene, const dem::WorldDefinition& world) {
  nb::dict d;
  d["method"] = std::string(dem::to_string(scene.physics.method));
  d["dt_s"] = world.dt;
  if (world.method == dem::Method::kXpbd) {
    d["substeps"] = world.xpbd.substeps;
    return d;
  }
  if (world.method == dem::Method::kDem) {
    d["integrator"] = world.dem.rests_implicitly ? "hybrid" : "explicit";
    d["steps_per_contact"] = world.dem.steps_per_contact;
    return d;
  }
  d["integrator"] = std::string(dem::to_string(world.integrator));
  d["stiffness_n_m"] = world.seed.stiffness;
  d["damping_ratio"] = world.seed.damping_ratio;
  d["tangential_damping_ratio"] = world.seed.tangential_damping_ratio;
  // One size only where the scene names one; otherwise each body has its own default.
  d["particle_size_m"] =
      scene.physics.particle_size ? nb::cast(*scene.physics.particle_size) : nb::object(nb::none());
  return d;
}

nb::object bound_name(dem::StiffnessBound bound) {
  switch (bound) {
    case dem::StiffnessBound::kImpact:
      return nb::cast("impact");
    case dem::StiffnessBound::kLoad:
      return nb::cast("load");
    case dem::StiffnessBound::kNamed:
      return nb::cast("named");
    case dem::StiffnessBound::kNone:
      break;
  }
  return nb::none();
}

/// What methods dem and xpbd chose from what the scene allows; none for seed.
nb::object chosen_dict(const dem::World& world, const dem::RunResult& result) {
  if (!world.surfaces) return nb::none();
  const dem::Chosen chosen = world.surfaces->chosen();
  const dem::HardestContact& hardest = result.hardest;
  nb::dict d;
  if (world.parameters.method == dem::Method::kXpbd) {
    const dem::ContactSettings& settings = world.surfaces->settings();
    d["substeps"] = world.parameters.xpbd.substeps;
    d["substep_s"] = settings.substep;
    d["restitution_threshold_m_s"] = settings.restitution_threshold;
    d["dt_s"] = result.dt;
    return d;
  }
  d["max_penetration_m"] = chosen.max_penetration;
  d["rest_penetration_m"] = chosen.rest_depth;
  d["predicted_penetration_m"] = hardest.predicted_penetration;
  d["stiffness"] = hardest.stiffness > 0 ? nb::cast(hardest.stiffness) : nb::object(nb::none());
  d["bound"] = bound_name(hardest.bound);
  d["dt_s"] = result.dt;
  return d;
}

/// States and contacts before the first failure, as arrays; none if the run did not fail or was
/// not asked to keep them.
nb::object last_moments(const dem::World& world, const dem::LastMoments& last) {
  if (last.log.times.empty()) return nb::none();
  const std::size_t num_contacts = last.contacts.size();
  std::vector<double> time, place, normal, depth, load;
  nb::list bodies;
  const auto name_of = [&](int body) {
    const int num_bodies = world.bodies.count();
    return body < num_bodies ? world.names[body] : world.planes[body - num_bodies].name;
  };
  for (const dem::ContactRecord& contact : last.contacts) {
    time.push_back(contact.time);
    append(contact.place, place);
    append(contact.normal, normal);
    depth.push_back(contact.depth);
    load.push_back(contact.load);
    bodies.append(nb::make_tuple(name_of(contact.a), name_of(contact.b)));
  }
  nb::object moments = nb::module_::import_("types").attr("SimpleNamespace")();
  set_pose_arrays(moments, last.log);
  moments.attr("contact_time_s") = array_of(time, {num_contacts});
  moments.attr("contact_bodies") = bodies;
  moments.attr("contact_place_m") = array_of(place, {num_contacts, 3});
  moments.attr("contact_normal") = array_of(normal, {num_contacts, 3});
  moments.attr("contact_depth_m") = array_of(depth, {num_contacts});
  moments.attr("contact_load_n") = array_of(load, {num_contacts});
  return moments;
}

nb::object simulate(const scene::Scene& scene, std::optional<double> sample_interval,
                    int num_threads, const nb::object& progress, double keep_before_failure) {
  dem::RunOptions options;
  options.keep_before_failure = keep_before_failure;
  options.duration = scene.duration;
  options.sample_interval = sample_interval.value_or(1 / scene.frame_rate);
  if (!scene.stands.empty()) options.expect.push_back({scene.stands});
  options.progress = [&](double time) {
    const nb::gil_scoped_acquire acquire;
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
    if (!progress.is_none()) progress(time, scene.duration);
  };

  dem::RunResult result;
  std::optional<dem::World> world;
  scene::BuiltScene built;
  {
    const nb::gil_scoped_release release;
    built = scene::build_world(scene);
    built.world.num_threads = num_threads;
    world.emplace(dem::make_world(built.world));
    result = dem::run(*world, options);
  }

  nb::object run = nb::module_::import_("types").attr("SimpleNamespace")();
  set_pose_arrays(run, result.log);
  const std::vector<double> state = final_state(world->bodies);
  run.attr("final_state") = array_of(state, {state.size()});
  run.attr("simulated_s") = world->time;
  run.attr("steps") = result.steps;
  run.attr("dt_s") = result.dt;
  run.attr("cpu_s") = result.cpu_s;
  run.attr("failed") = failure_dict(result.failed);
  nb::list failures;
  for (const dem::Failure& failure : result.failures) failures.append(failure_dict(failure));
  run.attr("failures") = failures;
  run.attr("metrics") = metrics_dict(result.metrics);
  run.attr("events") = event_list(result.events, *world);
  run.attr("bodies") = body_list(*world);
  run.attr("parameters") = parameters_dict(scene, built.world);
  run.attr("chosen") = chosen_dict(*world, result);
  run.attr("last") = last_moments(*world, result.last);
  return run;
}

}  // namespace

void bind_run(nb::module_& m) {
  m.def(
      "check_world",
      [](const scene::Scene& scene) { dem::make_world(scene::build_world(scene).world); },
      nb::arg("scene"));
  m.def("simulate", &simulate, nb::arg("scene"), nb::arg("sample_interval_s").none(),
        nb::arg("num_threads"), nb::arg("progress").none(), nb::arg("keep_before_failure_s"),
        nb::sig("def simulate(scene: Scene, sample_interval_s: float | None, num_threads: int, "
                "progress: object | None, keep_before_failure_s: float) -> typing.Any"));
}

}  // namespace verisim::python
