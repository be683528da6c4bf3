// SPDX-License-Identifier: MIT
// GLSL. Light is linear everywhere; encode() makes sRGB at the very end. The shaders are lean on
// purpose: on a software rasteriser each instruction of a fragment costs wall time.
#include "render/shaders.h"

namespace verisim::render {
namespace {

constexpr const char* kVersion = "#version 330 core\n";

// The sRGB curve (IEC 61966-2-1) by square roots, which a software rasteriser does faster than
// powers. Minimax fit over 0.003..1: off by at most 0.013 of an 8-bit step.
constexpr const char* kEncode = R"(
vec3 encode(vec3 linear) {
  vec3 a = sqrt(linear), b = sqrt(a), c = sqrt(b);
  return 0.64166755 * a + 0.71292339 * b - 0.3372117 * c - 0.01733003 * linear;
}
)";

// Mean, over a window of width w, of the wave that is +1 in even cells and -1 in odd ones: the
// difference of its integral, a triangle wave, at both ends of the window.
constexpr const char* kSquareWave = R"(
vec2 wave_integral(vec2 x) { return 1.0 - abs(x - 2.0 * floor(0.5 * x) - 1.0); }
vec3 wave_integral(vec3 x) { return 1.0 - abs(x - 2.0 * floor(0.5 * x) - 1.0); }
vec2 mean_wave(vec2 x, vec2 w) {
  return (wave_integral(x + 0.5 * w) - wave_integral(x - 0.5 * w)) / w;
}
vec3 mean_wave(vec3 x, vec3 w) {
  return (wave_integral(x + 0.5 * w) - wave_integral(x - 0.5 * w)) / w;
}
)";

// Share of the sun's light that arrives: two taps, each a bilinear mean of four comparisons. They
// are the dearest part of a fragment: four taps are no better to look at and cost 15 % of a frame.
constexpr const char* kSunlit = R"(
uniform sampler2DShadow shadow_map;
uniform vec2 shadow_tap;  // distance of a tap from the middle, shares of the map
float sunlit(vec3 p) {
  p.z = min(p.z, 1.0);  // farther than the map reaches: lit, as a map of floats would not have it
  return 0.5 * (texture(shadow_map, vec3(p.xy - shadow_tap, p.z)) +
                texture(shadow_map, vec3(p.xy + shadow_tap, p.z)));
}
)";

constexpr const char* kBodyInputs = R"(
layout(location = 0) in vec3 vertex_position;
layout(location = 1) in vec3 vertex_normal;
layout(location = 2) in vec4 sphere;  // centre and radius; 0 0 0 1 for a mesh
uniform mat4 body_to_world;
vec3 body_position() { return sphere.xyz + sphere.w * vertex_position; }
)";

// The ground is found from the pixel alone, not from interpolated corners, so that a patch of it
// that is drawn again has the very same bits.
constexpr const char* kGround = R"(
uniform mat3 pixel_to_ray;    // ray in ground axes, z along the normal
uniform vec3 eye;             // in ground axes
uniform float tiles_per_metre;
uniform vec2 tile_start;      // ground coordinates, in tiles, of the eye
uniform float fade;           // 1/m^2, how soon the ground melts into the horizon
uniform vec3 tile_dark, tile_light, horizon;
struct Ray { vec3 direction; float scale; };
Ray ground_ray() {
  vec3 r = pixel_to_ray * vec3(gl_FragCoord.xy, 1.0);
  return Ray(r, eye.z / -r.z);
}
vec3 ground_colour(Ray ray, vec3 light) {
  vec3 r = ray.direction;
  float s = ray.scale * tiles_per_metre;
  vec2 slope = r.xy / r.z;
  vec2 across = (pixel_to_ray[0].xy - slope * pixel_to_ray[0].z) * s;
  vec2 upward = (pixel_to_ray[1].xy - slope * pixel_to_ray[1].z) * s;
  vec2 waves = mean_wave(tile_start + r.xy * s, max(abs(across), abs(upward)) + 1e-3);
  vec3 paint = mix(tile_dark, tile_light, 0.5 + 0.5 * waves.x * waves.y);
  float near = exp2(-fade * ray.scale * ray.scale * dot(r, r));
  return mix(horizon, paint * light, near);
}
)";

}  // namespace

std::string caster_vertex_shader() {
  return std::string(kVersion) + kBodyInputs + R"(
uniform mat4 world_to_sun;
void main() {
  vec4 p = world_to_sun * (body_to_world * vec4(body_position(), 1.0));
  gl_Position = vec4(2.0 * p.xyz - 1.0, 1.0);
}
)";
}

std::string caster_fragment_shader() { return std::string(kVersion) + "void main() {}\n"; }

std::string body_vertex_shader() {
  return std::string(kVersion) + kBodyInputs + R"(
uniform mat4 world_to_clip, world_to_sun;
uniform vec4 ground_plane;    // bodies are cut where they dip below it
uniform float shadow_offset;  // m along the normal: keeps a lit face out of its own shadow
uniform vec3 pattern_scale, pattern_shift;  // body position to cells
out vec3 normal;
out vec3 cell;
out vec3 sun_position;
void main() {
  vec3 p_b = body_position();
  vec4 p = body_to_world * vec4(p_b, 1.0);
  normal = mat3(body_to_world) * vertex_normal;
  // A hair inside of the face: a face that lies on a border between cells takes the inner one.
  cell = p_b * pattern_scale + pattern_shift - 0.01 * vertex_normal;
  sun_position = (world_to_sun * vec4(p.xyz + shadow_offset * normal, 1.0)).xyz;
  gl_Position = world_to_clip * p;
  gl_ClipDistance[0] = dot(ground_plane.xyz, p.xyz) - ground_plane.w;
}
)";
}

std::string body_fragment_shader() {
  return std::string(kVersion) + kEncode + kSquareWave + kSunlit + R"(
in vec3 normal;
in vec3 cell;
in vec3 sun_position;
uniform vec3 tone_dark, tone_light;
uniform vec3 cell_low, cell_high;  // the body's extent in cells
uniform vec3 to_sun, up;
uniform vec3 sun_light, ambient_middle, ambient_slope;
out vec4 colour;
void main() {
  vec3 n = normalize(normal);
  vec3 window = max(abs(dFdx(cell)), abs(dFdy(cell))) + 1e-3;
  // The window stays on the body: beyond an edge the pattern would go on with the other tone.
  vec3 middle = clamp(cell, cell_low + 0.5 * window, cell_high - 0.5 * window);
  vec3 waves = mean_wave(middle, window);
  vec3 paint = mix(tone_dark, tone_light, 0.5 + 0.5 * waves.x * waves.y * waves.z);
  float facing = max(dot(n, to_sun), 0.0);
  vec3 light = sun_light * (facing * sunlit(sun_position)) + ambient_middle +
               ambient_slope * dot(n, up);
  colour = vec4(encode(paint * light), 1.0);
}
)";
}

std::string background_vertex_shader() {
  return std::string(kVersion) + R"(
void main() {
  vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  gl_Position = vec4(corner, 0.0, 1.0);
}
)";
}

std::string background_fragment_shader() {
  return std::string(kVersion) + kEncode + kSquareWave + kGround + R"(
uniform vec3 ground_light, zenith;
uniform float has_ground;
out vec4 colour;
void main() {
  Ray ray = ground_ray();
  vec3 r = ray.direction;
  float height = clamp(r.z * inversesqrt(dot(r, r)) * 1.6, 0.0, 1.0);
  vec3 sky = mix(horizon, zenith, height);
  bool is_ground = has_ground > 0.5 && r.z < 0.0 && eye.z > 0.0;
  colour = vec4(encode(is_ground ? ground_colour(ray, ground_light) : sky), 1.0);
}
)";
}

std::string shadow_area_vertex_shader() {
  return std::string(kVersion) + R"(
layout(location = 0) in vec2 pixel;
uniform vec2 pixel_to_clip;
uniform vec3 ground_depth;  // depth of the ground is linear over the picture
void main() {
  vec2 at = pixel * pixel_to_clip - 1.0;
  gl_Position = vec4(at, dot(ground_depth, vec3(at, 1.0)), 1.0);
}
)";
}

std::string shadow_area_fragment_shader() {
  return std::string(kVersion) + kEncode + kSquareWave + kSunlit + kGround + R"(
uniform mat4 ground_to_sun;  // ground axes to sun space
uniform vec3 ground_sun, ground_ambient;
out vec4 colour;
void main() {
  Ray ray = ground_ray();
  vec2 at = eye.xy + ray.direction.xy * ray.scale;
  vec3 p = (ground_to_sun * vec4(at, 0.0, 1.0)).xyz;
  colour = vec4(encode(ground_colour(ray, ground_ambient + ground_sun * sunlit(p))), 1.0);
}
)";
}

}  // namespace verisim::render
