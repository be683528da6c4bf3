// SPDX-License-Identifier: MIT
// Scene -> look: what the renderer draws for each body, ground and camera.
#pragma once

#include "render/visual_scene.h"
#include "scene/build_world.h"

namespace verisim::clip {

/// What stands for a body in the picture.
enum class Show { kMesh, kParticles };

/// The look of a scene. Free bodies take palette colours in file order, others a neutral grey. A
/// scene without a camera gets one that sees every body at the start.
render::VisualScene visualise(const scene::Scene& scene, const scene::BuiltScene& built, Show show);

}  // namespace verisim::clip
