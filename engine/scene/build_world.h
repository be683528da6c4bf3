// SPDX-License-Identifier: MIT
// Scene -> what the physics starts from (mass, inertia, particles) and what is drawn (meshes).
#pragma once

#include "dem/definition.h"
#include "scene/scene.h"
#include "shape/mesh.h"

namespace verisim::scene {

struct BuiltScene {
  dem::WorldDefinition world;       // every parameter chosen
  std::vector<shape::Mesh> meshes;  // surface per body: body axes, from the centre of mass, m
};

/// Loads and checks meshes, computes mass properties, fills bodies with particles and chooses the
/// parameters that the scene leaves open. A prescribed body needs Body::prescribed filled.
/// Throws SceneError (all unusable shapes at once).
BuiltScene build_world(const Scene& scene);

}  // namespace verisim::scene
