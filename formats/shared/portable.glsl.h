// SPDX-License-Identifier: Apache-2.0
// The dialect of *.glsl.h: the intersection of C++20 with GLM and GLSL 4.50, so that a formula is
// written once.
//
// Functions are GPU_FN, stand between SHARED_BEGIN and SHARED_END, and return a value or a small
// struct. No in, out, inout, swizzles, default members, templates, overloads, recursion, pointers
// or references; structs are declared, then assigned field by field; float literals end in f, uint
// literals in u.
//
// `real` (real2, real3) is float; a literal of it is REAL(0.1). A C++ file that wants double
// defines SHARED_NAMESPACE as shared::f64 before it includes a header; one that wants both
// redefines it between two inclusions (a header written in `real` therefore has no include guard
// for C++).
//
// A PRECISE variable is computed as written, without contraction or reordering (C++ is compiled so
// throughout).
#ifndef NEARFIELD_PORTABLE_GLSL_H
#define NEARFIELD_PORTABLE_GLSL_H

#ifdef __cplusplus

#include <glm/glm.hpp>

#include <cstdint>

#define GPU_FN inline
#define PRECISE
#define REAL(x) static_cast<real>(x)
#define SHARED_BEGIN namespace nearfield::SHARED_NAMESPACE {
#define SHARED_END }

namespace nearfield::shared {

using uint = std::uint32_t;
using glm::ivec2, glm::ivec3, glm::ivec4;
using glm::uvec2, glm::uvec3, glm::uvec4;
using glm::vec2, glm::vec3, glm::vec4;

using glm::abs, glm::atan, glm::ceil, glm::floor, glm::fract, glm::round, glm::sign, glm::trunc;
using glm::clamp, glm::max, glm::min, glm::mix, glm::step;
using glm::cos, glm::exp, glm::exp2, glm::inversesqrt, glm::log, glm::log2, glm::pow, glm::sin,
    glm::sqrt;
using glm::cross, glm::distance, glm::dot, glm::length, glm::normalize, glm::reflect;

using real = float;
using real2 = glm::vec2;
using real3 = glm::vec3;

/// The same in double: its names hide the float ones.
namespace f64 {
using real = double;
using real2 = glm::dvec2;
using real3 = glm::dvec3;
}  // namespace f64

}  // namespace nearfield::shared

#else

#define GPU_FN
#define PRECISE precise
#define REAL(x) float(x)
#define SHARED_BEGIN
#define SHARED_END
#define real float
#define real2 vec2
#define real3 vec3

#endif

#endif

// The namespace that SHARED_BEGIN opens in C++.
#if defined(__cplusplus) && !defined(SHARED_NAMESPACE)
#define SHARED_NAMESPACE shared
#endif
