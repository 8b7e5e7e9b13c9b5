// SPDX-License-Identifier: Apache-2.0
// The scene's triangles as a cell of a lamp's U plane sees them. Depth is nearest / distance along
// the slab's axis.
layout(location = 0) in vec4 position;  // world, metres

layout(location = 0) uniform vec3 eye_world_m;
layout(location = 1) uniform mat3 slab_from_world;  // rotation, perhaps mirrored
layout(location = 2) uniform vec4 tangents;         // the view's middle; 1 / half its sides
layout(location = 3) uniform float nearest_m;

void main() {
    vec3 p = slab_from_world * (position.xyz - eye_world_m);
    gl_Position = vec4((p.xy - tangents.xy * p.z) * tangents.zw, nearest_m, p.z);
}
