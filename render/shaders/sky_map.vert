// SPDX-License-Identifier: Apache-2.0
// The scene's triangles as one of the environment's directions sees them: no perspective.
layout(location = 0) in vec4 position;  // world, metres

layout(location = 0) uniform mat4 clip_from_world;

void main() {
    gl_Position = clip_from_world * vec4(position.xyz, 1.0);
}
