// SPDX-License-Identifier: Apache-2.0
/// Rays of equal flux, drawn from a light field's own density.
///
/// Flux is int int L cos^4(theta) / delta^2 du ds. With irradiance weighting that is a sum of
/// products C_m(s) Phi_m(u): an image is drawn by its share, s by C_m's luminance, u by Phi_m's
/// profiles, each by inversion; nothing is rounded and nothing rejected. With radiance weighting
/// what is drawn so is kept with probability cos^4(theta).
#pragma once

#include "formats/files/lightfield.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <vector>

namespace nearfield::model {

/// Light that crosses U at u and S at s, in the frame of slab number `slab`.
struct EmittedRay {
    std::size_t slab = 0;
    glm::dvec2 u_m{0.0}, s_m{0.0};
    glm::dvec3 color{1.0};  // linear Rec.709 per unit of flux: Y = 1
};

class Emission {
  public:
    /// `lightfield` must outlive it. Throws Error where it holds no light. Memory: 8 bytes for
    /// every 16 texels.
    explicit Emission(const LightField& lightfield);

    /// Ray number `index` of the stream `seed`: always the same, independent of all others. Every
    /// ray carries the same part of the light field's luminous (or radiant) flux. Thread-safe.
    EmittedRay ray(std::uint64_t index, std::uint32_t seed) const;

  private:
    struct Image {
        std::size_t slab = 0;
        int m = 0;
    };
    // A profile's cells as cumulative shares.
    struct ProfileCdf {
        double whole = 0;             // integral of the profile
        std::vector<double> cells;    // upper ends, the last is 1
        std::vector<double> guesses;  // of x, at shares k / 256
    };

    glm::dvec2 draw_s(const Image& image,
                      std::size_t index,
                      double xi,
                      glm::dvec2 within,
                      glm::dvec3& color) const;
    double draw_profile(std::size_t slab, double xi) const;
    void tabulate_guesses(std::size_t slab);

    const LightField& lightfield_;
    std::vector<Image> images_;             // those with light
    std::vector<double> image_ends_;        // running sums of their flux (before cos^4)
    std::vector<std::size_t> block_begin_;  // of each image in block_ends_
    std::vector<double> block_ends_;        // running sums over an image's texels, every 16th
    std::vector<ProfileCdf> profiles_;      // of each slab
};

}  // namespace nearfield::model
