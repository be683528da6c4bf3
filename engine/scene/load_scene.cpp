// SPDX-License-Identifier: MIT
#include "scene/load_scene.h"

#include <set>

#include "scene/document.h"
#include "scene/validate.h"

namespace verisim::scene {
namespace {

Eigen::Vector3d vector_of(const YAML::Node& node) {
  return {*parse_number(node[0]), *parse_number(node[1]), *parse_number(node[2])};
}

void read(const YAML::Node& node, double& value) {
  if (node) value = *parse_number(node);
}
void read(const YAML::Node& node, std::optional<double>& value) {
  if (node) value = parse_number(node);
}
void read(const YAML::Node& node, Eigen::Vector3d& value) {
  if (node) value = vector_of(node);
}
void read(const YAML::Node& node, std::string& value) {
  if (node) value = node.Scalar();
}

// Reads a document that passed validate(): form is right, so only meaning is checked here.
class Reader {
 public:
  explicit Reader(const Document& document) : document_(document), root_(document.root) {}

  Scene read_scene() {
    scene_.file = document_.file;
    read(root_["name"], scene_.name);
    read(root_["purpose"], scene_.purpose);
    read(root_["duration_s"], scene_.duration);
    read(root_["frame_rate_hz"], scene_.frame_rate);
    read(root_["gravity_m_s2"], scene_.gravity);
    if (root_["seed"]) scene_.seed = static_cast<long long>(*parse_number(root_["seed"]));
    read_materials();
    read_bodies();
    read_ground();
    read_physics();
    read_modules();
    read_expectations();
    read_camera();
    if (const YAML::Node look = root_["look"]) {
      read(look["skin"], scene_.look.skin);
      read(look["ground_checker_m"], scene_.look.ground_checker);
    }
    if (!problems_.empty()) throw SceneError(std::move(problems_));
    YAML::Emitter emitter;
    emitter << root_;
    scene_.resolved_yaml = std::string(emitter.c_str()) + "\n";
    return std::move(scene_);
  }

 private:
  void add(const std::string& path, const YAML::Node& node, std::string allowed,
           std::string hint = "") {
    problems_.push_back(
        {document_.where(path, node), path, one_line(node), std::move(allowed), std::move(hint)});
  }

  std::string material_names() const {
    std::string names;
    for (const Material& m : scene_.materials) names += (names.empty() ? "" : ", ") + m.name;
    return names;
  }

  int material_index(const YAML::Node& node, const std::string& path) {
    for (std::size_t i = 0; i < scene_.materials.size(); ++i) {
      if (scene_.materials[i].name == node.Scalar()) return static_cast<int>(i);
    }
    add(path, node, "one of: " + material_names(), "define it under materials");
    return 0;
  }

  void read_materials() {
    for (const auto& entry : root_["materials"]) {
      Material material;
      material.name = entry.first.Scalar();
      read(entry.second["density_kg_m3"], material.density);
      read(entry.second["restitution"], material.restitution);
      read(entry.second["friction"], material.friction);
      read(entry.second["rolling_friction"], material.rolling_friction);
      read(entry.second["young_modulus_pa"], material.young_modulus);
      read(entry.second["poisson_ratio"], material.poisson_ratio);
      scene_.materials.push_back(material);
    }
    const YAML::Node pairs = root_["material_pairs"];
    for (std::size_t i = 0; pairs && i < pairs.size(); ++i) {
      const YAML::Node names = pairs[i]["materials"];
      const std::string path = "material_pairs." + std::to_string(i) + ".materials";
      if (names.size() != 2) {
        add(path, names, "two names");
        continue;
      }
      MaterialPair pair{material_index(names[0], path), material_index(names[1], path), {}, {}, {}};
      read(pairs[i]["restitution"], pair.restitution);
      read(pairs[i]["friction"], pair.friction);
      read(pairs[i]["rolling_friction"], pair.rolling_friction);
      scene_.material_pairs.push_back(pair);
    }
  }

  void read_shape(const YAML::Node& node, const std::string& path, ShapeSpec& shape) {
    if (node["scale"] && !node["mesh"]) {
      add(path + ".scale", node["scale"], "scale only beside mesh");
    }
    if (node["box_m"]) {
      shape.kind = ShapeKind::kBox;
      shape.box = vector_of(node["box_m"]);
    } else if (node["sphere_radius_m"]) {
      shape.kind = ShapeKind::kSphere;
      read(node["sphere_radius_m"], shape.radius);
    } else {
      shape.kind = ShapeKind::kMesh;
      shape.mesh = beside_scene(node["mesh"], path + ".mesh");
      read(node["scale"], shape.scale);
    }
  }

  std::filesystem::path beside_scene(const YAML::Node& node, const std::string& path) {
    const std::filesystem::path file = document_.file.parent_path() / node.Scalar();
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) {
      add(path, node, "a file that exists",
          "looked for " + file.lexically_normal().string() + "; paths are relative to the scene");
    }
    return file.lexically_normal();
  }

  void read_motion(const YAML::Node& node, const std::string& path, Body& body) {
    if (!node) return;
    if (node.IsMap()) {
      body.motion = dem::Motion::kPrescribed;
      body.poses_file = beside_scene(node["poses"], path + ".poses");
    } else if (node.Scalar() == "fixed") {
      body.motion = dem::Motion::kFixed;
    }
  }

  void read_orientation(const YAML::Node& node, const std::string& path, Body& body) {
    if (!node) return;
    Eigen::Quaterniond& q = body.initial.orientation;
    q = Eigen::Quaterniond(*parse_number(node[0]), *parse_number(node[1]), *parse_number(node[2]),
                           *parse_number(node[3]));
    if (q.norm() < 1e-6) {
      add(path, node, "a quaternion that is not zero", "[1, 0, 0, 0] is no rotation");
    } else {
      q.normalize();
    }
  }

  void read_bodies() {
    std::set<std::string> names;
    if (root_["bodies"].size() == 0) add("bodies", root_["bodies"], "at least one body");
    for (const auto& node : root_["bodies"]) {
      Body body;
      read(node["name"], body.name);
      const std::string path = "bodies." + body.name;
      if (!names.insert(body.name).second) add(path + ".name", node["name"], "a unique name");
      read_shape(node["shape"], path + ".shape", body.shape);
      body.material = material_index(node["material"], path + ".material");
      read(node["position_m"], body.initial.position);
      read_orientation(node["orientation_wxyz"], path + ".orientation_wxyz", body);
      read(node["velocity_m_s"], body.initial.linear_velocity);
      read(node["angular_velocity_rad_s"], body.initial.angular_velocity);
      read_motion(node["motion"], path + ".motion", body);
      check_rest(node, path, body);
      scene_.bodies.push_back(std::move(body));
    }
  }

  void check_rest(const YAML::Node& node, const std::string& path, const Body& body) {
    if (body.motion == dem::Motion::kFree) return;
    for (const char* key : {"velocity_m_s", "angular_velocity_rad_s"}) {
      if (node[key] && !vector_of(node[key]).isZero(0)) {
        add(path + "." + key, node[key], "absent or zero when motion is not free");
      }
    }
  }

  void read_ground() {
    const YAML::Node node = root_["ground"];
    if (!node) return;
    Ground ground;
    read(node["plane"]["normal"], ground.normal);
    read(node["plane"]["offset_m"], ground.offset);
    ground.material = material_index(node["material"], "ground.material");
    if (ground.normal.norm() < 1e-6) {
      add("ground.plane.normal", node["plane"]["normal"], "a vector that is not zero");
    } else {
      ground.normal.normalize();
    }
    scene_.ground = ground;
  }

  void read_physics() {
    const YAML::Node node = root_["physics"];
    if (!node) return;
    Physics& physics = scene_.physics;
    if (node["method"]) {
      for (const dem::Method method : {dem::Method::kSeed, dem::Method::kXpbd}) {
        if (node["method"].Scalar() == dem::to_string(method)) physics.method = method;
      }
    }
    read(node["integrator"], physics.integrator);
    read(node["max_penetration_m"], physics.max_penetration);
    if (node["steps_per_contact"]) {
      physics.steps_per_contact = node["steps_per_contact"].as<int>();
    }
    if (node["substeps"]) physics.substeps = node["substeps"].as<int>();
    const bool is_seed = physics.method == dem::Method::kSeed;
    const bool is_dem = physics.method == dem::Method::kDem;
    const bool is_xpbd = physics.method == dem::Method::kXpbd;
    const bool is_of_seed = physics.integrator == "seed" || physics.integrator == "rkmk4";
    if (is_xpbd && !physics.integrator.empty()) {
      add("physics.integrator", node["integrator"], "only with method: dem or seed");
    } else if (!physics.integrator.empty() && is_of_seed != is_seed) {
      add("physics.integrator", node["integrator"],
          is_seed ? "one of: seed, rkmk4 (method seed)" : "one of: hybrid, explicit (method dem)");
    }
    const auto belongs_to = [&](const char* key, bool holds, const char* method) {
      if (node[key] && !holds) {
        add(std::string("physics.") + key, node[key], std::string("only with method: ") + method);
      }
    };
    belongs_to("particle_size_m", is_seed, "seed");
    belongs_to("damping_ratio", is_seed, "seed");
    belongs_to("tangential_damping_ratio", is_seed, "seed");
    belongs_to("max_penetration_m", is_dem, "dem");
    belongs_to("steps_per_contact", is_dem, "dem");
    belongs_to("contact_law", is_dem, "dem");
    belongs_to("tangential_law", is_dem, "dem");
    belongs_to("stiffness_n_m", !is_xpbd, "dem or seed");
    belongs_to("substeps", is_xpbd, "xpbd");
    if (is_xpbd) refuse_rolling_friction();
    read_laws(node);
    read(node["particle_size_m"], physics.particle_size);
    read(node["dt_s"], physics.dt);
    read(node["stiffness_n_m"], physics.stiffness);
    read(node["damping_ratio"], physics.damping_ratio);
    read(node["tangential_damping_ratio"], physics.tangential_damping_ratio);
    if (physics.dt && *physics.dt > scene_.duration) {
      add("physics.dt_s", node["dt_s"], "at most duration_s");
    }
  }

  void refuse_rolling_friction() {
    const std::string allowed = "0 with method: xpbd", hint = "method dem resists rolling";
    for (const Material& material : scene_.materials) {
      if (material.rolling_friction == 0) continue;
      add("materials." + material.name + ".rolling_friction",
          root_["materials"][material.name]["rolling_friction"], allowed, hint);
    }
    for (std::size_t i = 0; i < scene_.material_pairs.size(); ++i) {
      if (scene_.material_pairs[i].rolling_friction.value_or(0) == 0) continue;
      add("material_pairs." + std::to_string(i) + ".rolling_friction",
          root_["material_pairs"][i]["rolling_friction"], allowed, hint);
    }
  }

  void read_laws(const YAML::Node& node) {
    std::string normal = "hunt_crossley", tangential = "spring";
    read(node["contact_law"], normal);
    read(node["tangential_law"], tangential);
    if (tangential == "rigid_stick") {
      scene_.physics.tangential_law = dem::TangentialLaw::kRigidStick;
    }
    if (normal == "linear") scene_.physics.contact_law = dem::NormalLaw::kLinear;
    if (normal != "hertz_mindlin") return;
    scene_.physics.contact_law = dem::NormalLaw::kHertzMindlin;
    for (const Body& body : scene_.bodies) {
      if (body.shape.kind == ShapeKind::kSphere) continue;
      add("physics.contact_law", node["contact_law"],
          "hertz_mindlin only where every body is a sphere",
          "body " + body.name + " is none; take hunt_crossley or linear");
    }
    for (const Material& material : scene_.materials) {
      for (const auto& [key, is_given] :
           {std::pair{"young_modulus_pa", material.young_modulus.has_value()},
            std::pair{"poisson_ratio", material.poisson_ratio.has_value()}}) {
        if (is_given) continue;
        add("materials." + material.name + "." + key, root_["materials"][material.name],
            std::string(key) + " of every material",
            "physics.contact_law hertz_mindlin computes its springs from it");
      }
    }
  }

  void read_modules() {
    const YAML::Node node = root_["modules"];
    if (!node) return;
    if (node.size() > 0 && scene_.physics.method == dem::Method::kSeed) {
      add("modules", node, "only with method: dem", "remove modules, or physics.method");
    }
    if (node["tethers"] && scene_.physics.method == dem::Method::kXpbd) {
      add("modules.tethers", node["tethers"], "only with method: dem");
    }
    if (node["wind"]) read_wind(node["wind"]);
    for (std::size_t i = 0; node["tethers"] && i < node["tethers"].size(); ++i) {
      read_tether(node["tethers"][i], "modules.tethers." + std::to_string(i));
    }
  }

  /// Index of the body of this name; -1, with a problem, if there is none.
  int body_index(const YAML::Node& node, const std::string& path) {
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
      if (scene_.bodies[i].name == node.Scalar()) return static_cast<int>(i);
    }
    add(path, node, "the name of a body");
    return -1;
  }

  void read_tether(const YAML::Node& node, const std::string& path) {
    dem::TetherDefinition tether;
    const YAML::Node one = node["body"], two = node["bodies"];
    if (one.IsDefined() == two.IsDefined() || (two && two.size() != 2)) {
      return add(path, node, "body, or bodies with two names");
    }
    if (one) {
      tether.body = body_index(one, path + ".body");
      if (tether.body < 0) return;
      if (!node["anchor_m"]) add(path + ".anchor_m", node, "the point of the world that holds it");
    } else {
      tether.body = body_index(two[0], path + ".bodies");
      tether.other = body_index(two[1], path + ".bodies");
      if (tether.body < 0 || tether.other < 0) return;
    }
    read(node["attach_m"], tether.attach_b);
    read(node["anchor_m"], tether.anchor);
    read(node["length_m"], tether.length);
    scene_.tethers.push_back(tether);
  }

  void read_wind(const YAML::Node& node) {
    dem::Wind wind;
    wind.velocity = vector_of(node["velocity_m_s"]);
    read(node["air_density_kg_m3"], wind.density);
    read(node["air_viscosity_pa_s"], wind.viscosity);
    read(node["drag_coefficient"], wind.drag_coefficient);
    scene_.wind = wind;
  }

  void read_expectations() {
    const YAML::Node stands = root_["expect"] ? root_["expect"]["stands"] : YAML::Node();
    for (const auto& node : stands) {
      const int body = body_index(node, "expect.stands");
      if (body >= 0) scene_.stands.push_back(body);
    }
  }

  void read_camera() {
    const YAML::Node node = root_["camera"];
    if (!node) return;
    Camera camera;
    camera.position = vector_of(node["position_m"]);
    camera.look_at = vector_of(node["look_at_m"]);
    read(node["fov_deg"], camera.fov_deg);
    if ((camera.position - camera.look_at).norm() < 1e-6) {
      add("camera.look_at_m", node["look_at_m"], "a point away from position_m");
    }
    scene_.camera = camera;
  }

  const Document& document_;
  const YAML::Node root_;
  Scene scene_;
  std::vector<Problem> problems_;
};

}  // namespace

Scene load_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
  const Document document = read_document(file, overrides);
  std::vector<Problem> problems = validate(document);
  if (!problems.empty()) throw SceneError(std::move(problems));
  return Reader(document).read_scene();
}

}  // namespace verisim::scene
