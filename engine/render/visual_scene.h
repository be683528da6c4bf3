// SPDX-License-Identifier: MIT
// What a scene looks like: plain data that, with a pose log, is all the renderer knows.
// Units are SI; the world is right-handed with z up; directions are unit vectors.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

namespace verisim::render {

/// An sRGB-encoded colour, each channel 0..1: what a colour picker shows.
struct Colour {
  float red = 0.5F;
  float green = 0.5F;
  float blue = 0.5F;
};

/// A pin-hole camera, upright in the world.
struct Camera {
  Eigen::Vector3d position{1.2, -1.5, 0.8};  // m
  Eigen::Vector3d look_at{0, 0, 0.2};        // m
  double fov_deg = 40;                       // vertical angle of view
};

/// The one light that casts shadows.
struct Sun {
  Eigen::Vector3d direction{-0.42, -0.42, 0.80};  // from the scene to the sun
};

/// The ground: the half space below normal . x = offset, painted with square tiles.
struct Ground {
  bool present = true;
  Eigen::Vector3d normal{0, 0, 1};
  double offset = 0;           // m
  double checker_size = 0.25;  // m, edge of one tile: the scale cue of the picture
};

/// How the two tones of a body alternate, in the body's own frame, so that rotation shows.
enum class PatternKind { kPlain, kChecker, kBands };

struct Pattern {
  PatternKind kind = PatternKind::kChecker;
  Eigen::Vector3d cell{0.1, 0.1, 0.1};  // m, edges of one cell; bands alternate along z only
  Eigen::Vector3d origin{0, 0, 0};      // m from the centre of mass, a corner of a cell
};

/// Triangles wind counter-clockwise seen from outside.
struct TriangleMesh {
  std::vector<Eigen::Vector3d> positions;     // m
  std::vector<std::array<int, 3>> triangles;  // indices into positions
};

struct Sphere {
  Eigen::Vector3d center;  // m from the centre of mass, body axes
  double radius = 0;       // m
};

/// One rigid thing: a closed mesh, or spheres (a ball is one; a particle view has many).
struct VisualBody {
  std::string name;
  Colour colour;
  Pattern pattern;
  TriangleMesh mesh;
  Eigen::Vector3d mesh_offset{0, 0, 0};  // m, added to mesh positions: minus the centre of mass
  std::vector<Sphere> spheres;
};

/// Bodies are in the order of the pose log.
struct VisualScene {
  Camera camera;
  Sun sun;
  Ground ground;
  std::vector<VisualBody> bodies;
};

/// A sun high on the left behind this camera: people assume light from above left, and a shadow
/// that falls to the right and away from the viewer stays in sight beside its body.
Sun sun_behind_camera(const Camera& camera);

/// Colour of body `index`: distinct for people with any common colour vision, and matte.
Colour palette_colour(std::size_t index);

/// Colour of things that only hold others: ramps, tables, walls.
Colour fixed_body_colour();

/// Checker for a box that is centred on its centre of mass: whole cells on every edge, about as
/// wide as deep, four along the longest edge and two at least along any that has room for them.
Pattern box_pattern(const Eigen::Vector3d& edges);

/// Checker of a sphere: its eight octants.
Pattern sphere_pattern(double radius);

/// Checker for a mesh whose bounding box, from the centre of mass, goes from `low` to `high`.
Pattern mesh_pattern(const Eigen::Vector3d& low, const Eigen::Vector3d& high);

/// A box centred on the origin.
TriangleMesh box_mesh(const Eigen::Vector3d& edges);

}  // namespace verisim::render
