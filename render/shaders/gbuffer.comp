// SPDX-License-Identifier: Apache-2.0
// Where each pixel's ray meets the triangle that is seen there, as render/cpu/tracer.cpp finds it.
#ifdef HAS_TURNS
#include "formats/shared/sample_count.glsl.h"
#endif

layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform usampler2D seen_triangle;  // 1 + triangle; 0: none
layout(std430, binding = 4) readonly restrict buffer Positions { vec4 positions[]; };
layout(std430, binding = 5) readonly restrict buffer Normals { vec4 normals[]; };
layout(std430, binding = 6) readonly restrict buffer Tangents { vec4 tangents[]; };
layout(std430, binding = 7) readonly restrict buffer Indices { uint indices[]; };

// What surface.glsl reads.
layout(rgba32f, binding = 0) uniform writeonly restrict image2D position_image;
layout(rgba32f, binding = 1) uniform writeonly restrict image2D normal_image;
#ifdef HAS_TANGENTS
layout(rgba32f, binding = 2) uniform writeonly restrict image2D tangent_image;
#endif

#ifdef HAS_TURNS
layout(r32f, binding = 3) uniform writeonly restrict image2D turn_image;
layout(location = 3) uniform float pixel_width;  // at depth 1
#endif

layout(location = 0) uniform dvec3 eye_world_m;
layout(location = 1) uniform dmat3 world_from_pixel;  // of (x, y, 1), to a direction of any length
layout(location = 2) uniform vec3 forward;

// Nearer to grazing the plane says little of where along the ray it is met: the nearest point of
// the triangle is taken. Cosine.
const double kGrazing = 1e-3lf;

vec3 mix3(vec3 weights, vec3 a, vec3 b, vec3 c) {
    return weights.x * a + weights.y * b + weights.z * c;
}

#ifdef HAS_TURNS
// How far the normal turns across a pixel, as render/cpu/tracer.cpp finds it.
float turn_rad(uint ia, uint ib, uint ic, float depth_m) {
    vec3 a = normals[ia].xyz, b = normals[ib].xyz, c = normals[ic].xyz;
    if (a == vec3(0.0) || b == vec3(0.0) || c == vec3(0.0))
        return 0.0;
    return pixel_width * depth_m *
           triangle_curvature(positions[ib].xyz - positions[ia].xyz,
                              positions[ic].xyz - positions[ib].xyz, normalize(a), normalize(b),
                              normalize(c));
}
#endif

// A point of the triangle's plane by its corners' weights.
dvec3 weights_of(dvec3 p, dvec3 a, dvec3 b, dvec3 c, dvec3 normal) {
    double whole = dot(normal, normal);
    double of_b = dot(cross(p - a, c - a), normal) / whole;
    double of_c = dot(cross(b - a, p - a), normal) / whole;
    return dvec3(1.0lf - of_b - of_c, of_b, of_c);
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(position_image)))) {
        return;
    }
    uint triangle = texelFetch(seen_triangle, pixel, 0).r;
    dvec3 direction = normalize(world_from_pixel * dvec3(pixel, 1.0lf));
    if (triangle == 0u) {
        imageStore(position_image, pixel, vec4(0.0));
        imageStore(normal_image, pixel, vec4(vec3(direction), 0.0));
#ifdef HAS_TANGENTS
        imageStore(tangent_image, pixel, vec4(0.0));
#endif
#ifdef HAS_TURNS
        imageStore(turn_image, pixel, vec4(0.0));
#endif
        return;
    }
    uint first = 3u * (triangle - 1u);
    uint ia = indices[first], ib = indices[first + 1u], ic = indices[first + 2u];
    // Corners about the eye: what follows is then about the triangle's size, not the world's.
    dvec3 a = dvec3(positions[ia].xyz) - eye_world_m;
    dvec3 b = dvec3(positions[ib].xyz) - eye_world_m;
    dvec3 c = dvec3(positions[ic].xyz) - eye_world_m;
    dvec3 plane = cross(b - a, c - a);
    double cosine = dot(plane, direction) / length(plane);
    dvec3 hit = abs(cosine) > 0.0lf ? direction * (dot(plane, a) / dot(plane, direction)) : a;
    dvec3 weights = weights_of(hit, a, b, c, plane);
    if (abs(cosine) < kGrazing) {
        weights = clamp(weights, 0.0lf, 1.0lf);
        weights /= weights.x + weights.y + weights.z;
        hit = weights.x * a + weights.y * b + weights.z * c;
    }

    vec3 w = vec3(weights);
    vec3 geometric = vec3(normalize(plane) * (cosine > 0.0lf ? -1.0lf : 1.0lf));
    vec3 normal = mix3(w, normals[ia].xyz, normals[ib].xyz, normals[ic].xyz);
    // Opposite vertex normals may cancel; the triangle's own serves there, and where there are none.
    float square = dot(normal, normal);
    normal = square > 0.0 ? normal * inversesqrt(square) : geometric;
    if (dot(normal, geometric) < 0.0) {
        normal = -normal;
    }
    imageStore(position_image, pixel, vec4(vec3(hit + eye_world_m), positions[ia].w));
    imageStore(normal_image, pixel, vec4(normal, dot(forward, vec3(hit))));
#ifdef HAS_TURNS
    imageStore(turn_image, pixel, vec4(turn_rad(ia, ib, ic, dot(forward, vec3(hit)))));
#endif
#ifdef HAS_TANGENTS
    imageStore(tangent_image, pixel,
               vec4(mix3(w, tangents[ia].xyz, tangents[ib].xyz, tangents[ic].xyz), 0.0));
#endif
}
