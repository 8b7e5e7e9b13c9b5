// SPDX-License-Identifier: Apache-2.0
// The scene's triangles as a camera sees them. Depth is nearest / distance: in float as precise far
// away as near by, whatever `nearest_m` is.

layout(location = 0) in vec4 position;  // world, metres

layout(location = 0) uniform vec3 eye_world_m;
layout(location = 1) uniform mat3 camera_from_world;
layout(location = 2) uniform vec2 scale;  // of tangents to half the film's sides
layout(location = 3) uniform vec2 shift;
layout(location = 4) uniform float nearest_m;

void main() {
    vec3 camera_m = camera_from_world * (position.xyz - eye_world_m);
    float depth_m = -camera_m.z;
    gl_Position = vec4(scale * camera_m.xy + shift * depth_m, nearest_m, depth_m);
}
