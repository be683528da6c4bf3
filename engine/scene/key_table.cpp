// SPDX-License-Identifier: MIT
#include "scene/key_table.h"

#include <cstdio>

namespace verisim::scene {
namespace {

std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

std::string bounds_text(const Key& key) {
  std::string text;
  if (key.above) text += " > " + number_text(*key.above);
  if (key.at_least) text += " >= " + number_text(*key.at_least);
  if (key.at_most) text += (text.empty() ? " <= " : " and <= ") + number_text(*key.at_most);
  return text;
}

std::string join(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

Key vector_key(const char* name, const char* description, const char* default_text = "",
               bool required = false, int length = 3) {
  return {.name = name,
          .kind = Kind::kVector,
          .required = required,
          .description = description,
          .default_text = default_text,
          .length = length};
}

std::vector<Key> material_keys() {
  return {
      {.name = "density_kg_m3",
       .kind = Kind::kNumber,
       .required = true,
       .description = "Mass per volume, kg/m3.",
       .above = 0},
      {.name = "restitution",
       .kind = Kind::kNumber,
       .description = "Coefficient of restitution. Method seed does not read it: its rebound "
                      "follows from damping_ratio and the number of particles.",
       .default_text = "0.5",
       .at_least = 0,
       .at_most = 1},
      {.name = "friction",
       .kind = Kind::kNumber,
       .description = "Coulomb coefficient. Method seed does not read it: its tangential force "
                      "is viscous.",
       .default_text = "0.5",
       .at_least = 0},
      {.name = "rolling_friction",
       .kind = Kind::kNumber,
       .description = "Method dem: torque that resists the rolling of a sphere, over load times "
                      "radius. A pair has it if both materials do, or material_pairs says so; its "
                      "islands take explicit steps.",
       .default_text = "0",
       .at_least = 0},
      {.name = "young_modulus_pa",
       .kind = Kind::kNumber,
       .description = "Young's modulus, Pa. physics.contact_law hertz_mindlin alone reads it.",
       .above = 0},
      {.name = "poisson_ratio",
       .kind = Kind::kNumber,
       .description = "Poisson's ratio. physics.contact_law hertz_mindlin alone reads it.",
       .above = -1,
       .at_most = 0.5},
  };
}

std::vector<Key> material_pair_keys() {
  return {
      {.name = "materials",
       .kind = Kind::kNameList,
       .required = true,
       .description = "The two materials."},
      {.name = "restitution",
       .kind = Kind::kNumber,
       .description = "Of this pair; otherwise the geometric mean of the two materials.",
       .at_least = 0,
       .at_most = 1},
      {.name = "friction",
       .kind = Kind::kNumber,
       .description = "Of this pair; otherwise the geometric mean of the two materials.",
       .at_least = 0},
      {.name = "rolling_friction",
       .kind = Kind::kNumber,
       .description = "Of this pair; otherwise the geometric mean of the two materials.",
       .at_least = 0},
  };
}

Key shape_key() {
  Key key{.name = "shape",
          .kind = Kind::kMap,
          .required = true,
          .description = "Exactly one of box_m, sphere_radius_m and mesh.",
          .exactly_one_of_required = true};
  Key box = vector_key("box_m", "Full edge lengths along the body's own axes, m.", "", true);
  box.above = 0;
  key.children = {
      box,
      {.name = "sphere_radius_m",
       .kind = Kind::kNumber,
       .required = true,
       .description = "Radius, m.",
       .above = 0},
      {.name = "mesh",
       .kind = Kind::kPath,
       .required = true,
       .description = "Closed triangle mesh: OBJ, PLY, STL or glTF."},
      {.name = "scale",
       .kind = Kind::kNumber,
       .description = "Factor from mesh units to metres.",
       .default_text = "1",
       .above = 0},
  };
  return key;
}

std::vector<Key> body_keys() {
  return {
      {.name = "name",
       .kind = Kind::kIdentifier,
       .required = true,
       .description = "Unique name of the body."},
      shape_key(),
      {.name = "material",
       .kind = Kind::kText,
       .required = true,
       .description = "A name from materials."},
      vector_key("position_m", "Centre of mass at the start, world frame, m.", "[0, 0, 0]"),
      vector_key("orientation_wxyz",
                 "Orientation at the start: quaternion from body to world, w first; normalised "
                 "on reading.",
                 "[1, 0, 0, 0]", false, 4),
      vector_key("velocity_m_s", "Velocity of the centre of mass at the start, m/s.", "[0, 0, 0]"),
      vector_key("angular_velocity_rad_s", "Angular velocity at the start, world frame, rad/s.",
                 "[0, 0, 0]"),
      {.name = "motion",
       .kind = Kind::kChoiceOrMap,
       .description = "free: moved by forces. fixed: never moves. {poses: FILE.npz}: follows a "
                      "pose log's body of the same name.",
       .default_text = "free",
       .choices = {"free", "fixed"},
       .children = {{.name = "poses",
                     .kind = Kind::kPath,
                     .required = true,
                     .description = "Pose log (.npz) with a body of this name."}}},
  };
}

Key ground_key() {
  Key plane{.name = "plane",
            .kind = Kind::kMap,
            .required = true,
            .description = "Half-space below the plane normal . x = offset is solid."};
  plane.children = {
      vector_key("normal", "Points out of the ground; normalised on reading.", "[0, 0, 1]"),
      {.name = "offset_m",
       .kind = Kind::kNumber,
       .description = "Distance of the plane from the origin along the normal, m.",
       .default_text = "0"},
  };
  return {.name = "ground",
          .kind = Kind::kMap,
          .description = "A fixed plane. Absent: nothing to fall on.",
          .children = {plane,
                       {.name = "material",
                        .kind = Kind::kText,
                        .required = true,
                        .description = "A name from materials."}}};
}

std::vector<Key> physics_keys() {
  return {
      {.name = "method",
       .kind = Kind::kChoice,
       .description =
           "Contact method. dem: surfaces, springs chosen from the penetration allowed, "
           "restitution and Coulomb friction of the materials. xpbd: the same surfaces as rigid "
           "ones, positions corrected in small steps. seed: particles with "
           "springs and dashpots, as in the source paper.",
       .default_text = "dem",
       .choices = {"dem", "xpbd", "seed"}},
      {.name = "integrator",
       .kind = Kind::kChoice,
       .description =
           "Of dem: hybrid (impacts in explicit steps, rest in implicit ones) or explicit "
           "(explicit steps throughout). Of seed: seed (semi-implicit Euler with an "
           "Euler quaternion step) or rkmk4 (kick-drift-kick with a fourth-order "
           "rotation).",
       .default_text = "hybrid with dem, seed with seed",
       .choices = {"hybrid", "explicit", "seed", "rkmk4"}},
      {.name = "max_penetration_m",
       .kind = Kind::kNumber,
       .description = "Overlap that method dem may allow, m: it chooses stiffness and steps by it.",
       .default_text = "0.1 % of the smallest free body",
       .above = 0},
      {.name = "steps_per_contact",
       .kind = Kind::kInteger,
       .description = "Explicit steps of method dem in one elastic impact.",
       .default_text = "40",
       .at_least = 20,
       .at_most = 1000},
      {.name = "contact_law",
       .kind = Kind::kChoice,
       .description =
           "Normal force of method dem. hunt_crossley: linear spring, damping by the approach "
           "speed. linear: linear spring and dashpot, no pull. hertz_mindlin: spheres on spheres "
           "and planes, from young_modulus_pa and poisson_ratio. The last two take explicit steps.",
       .default_text = "hunt_crossley",
       .choices = {"hunt_crossley", "linear", "hertz_mindlin"}},
      {.name = "tangential_law",
       .kind = Kind::kChoice,
       .description = "Friction of method dem below Coulomb's limit. spring: elastic, an impact "
                      "that sticks springs back. rigid_stick: an impact that sticks does not; "
                      "it takes explicit steps.",
       .default_text = "spring",
       .choices = {"spring", "rigid_stick"}},
      {.name = "substeps",
       .kind = Kind::kInteger,
       .description =
           "Method xpbd: equal steps in dt_s of bodies that touch. Penetration falls with "
           "their square, the speed below which nothing rebounds (2 g dt_s / substeps) "
           "with their number.",
       .default_text = "20",
       .at_least = 1,
       .at_most = 10000},
      {.name = "particle_size_m",
       .kind = Kind::kNumber,
       .description = "Method seed: particle diameter of boxes and meshes, m. A ball is always one "
                      "particle.",
       .default_text = "a quarter of the body's smallest extent",
       .above = 0},
      {.name = "dt_s",
       .kind = Kind::kNumber,
       .description =
           "Of seed: time step, s. Of dem: longest step, s; impacts choose their own. Of xpbd: the "
           "time that substeps share.",
       .default_text = "seed: from the stiffest contact; dem and xpbd: 1/60 s",
       .above = 0},
      {.name = "stiffness_n_m",
       .kind = Kind::kNumber,
       .description = "Normal spring of one contact, N/m; with dem every contact's, whatever "
                      "its load.",
       .default_text =
           "seed: from the heaviest load; dem: each contact's own, from impact and load",
       .above = 0},
      {.name = "damping_ratio",
       .kind = Kind::kNumber,
       .description =
           "Method seed: normal dashpot of one particle contact, as a share of critical damping of "
           "the two particles.",
       .default_text = "1",
       .at_least = 0},
      {.name = "tangential_damping_ratio",
       .kind = Kind::kNumber,
       .description =
           "Method seed: viscous tangential coefficient, as a share of the same critical value.",
       .default_text = "0.5",
       .at_least = 0},
  };
}

Key wind_key() {
  return {.name = "wind",
          .kind = Kind::kMap,
          .description =
              "Air that moves past the bodies: quadratic drag on windward surfaces; of "
              "spheres the drag of Schiller and Naumann. No buoyancy.",
          .children = {
              vector_key("velocity_m_s", "Velocity of the air, m/s; zero is still air.", "", true),
              {.name = "air_density_kg_m3",
               .kind = Kind::kNumber,
               .description = "Mass of air per volume, kg/m3.",
               .default_text = "1.2",
               .above = 0},
              {.name = "air_viscosity_pa_s",
               .kind = Kind::kNumber,
               .description = "Dynamic viscosity, Pa s; spheres alone feel it.",
               .default_text = "1.8e-5",
               .at_least = 0},
              {.name = "drag_coefficient",
               .kind = Kind::kNumber,
               .description = "Of surfaces across the wind; spheres have their own.",
               .default_text = "1",
               .at_least = 0}}};
}

Key tethers_key() {
  return {.name = "tethers",
          .kind = Kind::kList,
          .description =
              "Inextensible lines that pull, never push, and may hang slack. Bodies on "
              "them take explicit steps.",
          .children = {{.name = "body",
                        .kind = Kind::kText,
                        .description = "The body that hangs from a point of the world."},
                       {.name = "bodies",
                        .kind = Kind::kNameList,
                        .description = "In place of body: two bodies that the line joins."},
                       vector_key("attach_m",
                                  "Where the line holds the body, or the first of two: in its own "
                                  "frame, from its centre of mass, m.",
                                  "[0, 0, 0]"),
                       vector_key("anchor_m",
                                  "The other end: a point of the world; of two bodies, in the "
                                  "frame of the second, from its centre of mass, m.",
                                  "[0, 0, 0]"),
                       {.name = "length_m",
                        .kind = Kind::kNumber,
                        .description = "Length of the line, m; 0: a ball joint.",
                        .default_text = "the distance of its ends at the start",
                        .at_least = 0}}};
}

Key modules_key() {
  return {.name = "modules",
          .kind = Kind::kMap,
          .description =
              "What else acts on the bodies, with method dem; wind also with xpbd. What is absent "
              "is not "
              "modelled and costs nothing.",
          .children = {wind_key(), tethers_key()}};
}

}  // namespace

const Key& scene_keys() {
  static const Key root = [] {
    Key key{.name = "", .kind = Kind::kMap, .description = "A Verisim scene."};
    key.children = {
        {.name = "schema",
         .kind = Kind::kInteger,
         .required = true,
         .description = "Version of this format.",
         .at_least = 1,
         .at_most = 1},
        {.name = "name",
         .kind = Kind::kIdentifier,
         .required = true,
         .description = "Short name, used in file names and tables."},
        {.name = "purpose",
         .kind = Kind::kText,
         .description = "One paragraph: what the scene shows and why."},
        {.name = "duration_s",
         .kind = Kind::kNumber,
         .required = true,
         .description = "Simulated time, s.",
         .above = 0,
         .at_most = 3600},
        {.name = "frame_rate_hz",
         .kind = Kind::kNumber,
         .description = "Video frames per simulated second.",
         .default_text = "60",
         .above = 0,
         .at_most = 1000},
        {.name = "seed",
         .kind = Kind::kInteger,
         .description = "Of everything random in the scene.",
         .default_text = "1",
         .at_least = 0,
         .at_most = 9007199254740991.0},
        vector_key("gravity_m_s2", "Acceleration of gravity, m/s2.", "[0, 0, -9.81]"),
        {.name = "materials",
         .kind = Kind::kNamedMap,
         .required = true,
         .description = "Materials by name.",
         .children = material_keys()},
        {.name = "material_pairs",
         .kind = Kind::kList,
         .description = "Pairs whose contact differs from the geometric mean.",
         .children = material_pair_keys()},
        {.name = "bodies",
         .kind = Kind::kList,
         .required = true,
         .description = "Rigid bodies; their order is the order of every result.",
         .children = body_keys()},
        ground_key(),
        {.name = "physics",
         .kind = Kind::kMap,
         .description = "How to compute; all optional.",
         .children = physics_keys()},
        modules_key(),
        {.name = "expect",
         .kind = Kind::kMap,
         .description = "What a right run does; a run that does not is reported as failed.",
         .children = {{.name = "stands",
                       .kind = Kind::kNameList,
                       .description = "Bodies that must stay where they stand."}}},
        {.name = "camera",
         .kind = Kind::kMap,
         .description = "Pin-hole camera; absent: one that sees all bodies.",
         .children = {vector_key("position_m", "Eye, world frame, m.", "", true),
                      vector_key("look_at_m", "Point in the middle of the picture, m.", "", true),
                      {.name = "fov_deg",
                       .kind = Kind::kNumber,
                       .description = "Vertical field of view, degrees.",
                       .default_text = "40",
                       .above = 1,
                       .at_most = 120}}},
        {.name = "look",
         .kind = Kind::kMap,
         .description = "What the pictures look like; no effect on the physics.",
         .children = {{.name = "skin",
                       .kind = Kind::kChoice,
                       .description = "checker: two-tone pattern that shows rotation. plain: one "
                                      "colour.",
                       .default_text = "checker",
                       .choices = {"checker", "plain"}},
                      {.name = "ground_checker_m",
                       .kind = Kind::kNumber,
                       .description = "Edge of one square of the ground, m: the cue to size.",
                       .default_text = "0.25",
                       .above = 0}}},
    };
    return key;
  }();
  return root;
}

std::string allowed_text(const Key& key) {
  switch (key.kind) {
    case Kind::kNumber:
      return "a number" + bounds_text(key);
    case Kind::kInteger:
      return "a whole number" + bounds_text(key);
    case Kind::kText:
      return "text";
    case Kind::kIdentifier:
      return "a name of letters, digits, '_' and '-'";
    case Kind::kPath:
      return "a path relative to the scene file";
    case Kind::kVector:
      return "a list of " + std::to_string(key.length) + " numbers" + bounds_text(key);
    case Kind::kChoice:
      return "one of: " + join(key.choices);
    case Kind::kMap:
      return "a map of keys";
    case Kind::kNamedMap:
      return "a map from name to keys";
    case Kind::kList:
      return "a list of maps";
    case Kind::kNameList:
      return "a list of names";
    case Kind::kChoiceOrMap:
      return "one of: " + join(key.choices) + ", or {" + key.children.front().name + ": FILE.npz}";
  }
  return {};
}

}  // namespace verisim::scene
