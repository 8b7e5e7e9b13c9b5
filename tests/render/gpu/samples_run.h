// SPDX-License-Identifier: Apache-2.0
/// One lamp's samples at known receivers, by OpenGL and by the CPU.
#pragma once

#include "formats/model/sampler.h"
#include "render/gpu/light_samples.h"
#include "render/gpu/surfaces.h"
#include "render/sample_sets.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace nearfield::render::gpu {

/// A slab and where it stands.
struct TestSlab {
    model::SamplingSlab sampling;
    SlabPlacement placement;
};

TestSlab make_test_slab(Slab slab, const glm::dmat4& world_from_slab = glm::dmat4(1.0));

struct SamplesCase {
    SampleNeeds needs;
    std::vector<TestSlab> slabs;
    glm::ivec2 size_px{0};
    std::vector<SurfacePoint> points;  // [row][column]
    shared::Brdf brdf{};
    glm::vec3 eye_m{0.3F, -0.2F, -40.0F};
    SampleQuery query;
    std::uint64_t most_energies = LightSamples().most_energies;
};

/// Lambert's, not gray.
shared::Brdf lambert();

/// Receivers that rays through random points of U and S reach, at heights of 0.05 ... 30 delta,
/// with normals within 60 degrees of -z; in the slab's frame.
std::vector<SurfacePoint> lit_points(const Slab& slab, glm::ivec2 size_px, std::uint64_t seed);

/// What is added at every pixel.
struct PixelLight {
    glm::vec3 radiance{0.0F}, irradiance{0.0F};
    float variance_y = 0.0F;
};

/// drawing: made for samples.needs; one serves many cases.
std::vector<PixelLight> light_by_gl(Device& device,
                                    LightSamples& drawing,
                                    const SamplesCase& samples);
std::vector<PixelLight> light_by_gl(Device& device, const SamplesCase& samples);
/// The CPU's renderer without shadows.
std::vector<PixelLight> light_by_cpu(const SamplesCase& samples);

/// How two frames differ, over pixels whose irradiance is above 1e-3 of the largest.
struct Difference {
    std::size_t pixels = 0;     // compared
    std::size_t different = 0;  // irradiance or radiance by more than 1e-3 of its largest channel
    double median = 0, worst = 0;
    double worst_variance = 0;  // of variances, relative, among pixels that do not differ
    bool is_finite = true;      // and nowhere negative
};

Difference difference(std::span<const PixelLight> found, std::span<const PixelLight> expected);

}  // namespace nearfield::render::gpu
