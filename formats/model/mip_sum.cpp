// SPDX-License-Identifier: Apache-2.0
#include "formats/model/mip_sum.h"

#include "formats/model/tables.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace nearfield::model {
namespace {

// The slab with every 2 x 2 texels averaged. Where a size is odd S's rectangle grows by a texel of
// the finer level, which is dark: each level holds the same light.
Slab halved(Slab& slab) {
    // All but the coefficients is copied.
    std::vector<float> coeffs = std::exchange(slab.coeffs, {});
    std::vector<float> sigma = std::exchange(slab.sigma, {});
    Slab coarse = slab;
    slab.coeffs = std::move(coeffs);
    slab.sigma = std::move(sigma);
    const auto planes =
        static_cast<std::size_t>(slab.channels) * static_cast<std::size_t>(slab.image_count());
    MipLevel level = halve(slab.coeffs.data(), slab.texels, planes);
    coarse.texels = level.texels;
    coarse.coeffs = std::move(level.coeffs);
    coarse.s_max_m = slab.s_min_m + 2.0 * slab.texel_m() * glm::dvec2(level.texels);
    return coarse;
}

}  // namespace

PreparedMips prepare_mips(Slab slab) {
    PreparedMips mips;
    float widest_centroid_texel_t = kWidestCentroidTexelT;
    while (slab.texels.x > 1 || slab.texels.y > 1) {
        Slab coarse = halved(slab);
        mips.levels.push_back(prepare(std::move(slab)));
        mips.levels.back().widest_centroid_texel_t = widest_centroid_texel_t;
        // Pieces in double would cost more than the exact sum; what the centroid errs, 4 times as
        // much a level, is far below the level's bias.
        widest_centroid_texel_t *= 2.0F;
        slab = std::move(coarse);
    }
    mips.levels.push_back(prepare(std::move(slab)));
    mips.levels.back().widest_centroid_texel_t = widest_centroid_texel_t;
    return mips;
}

int level_for(const PreparedMips& mips, const ReceiverF& receiver, int q) {
    assert(q >= 0);
    const Slab& slab = mips.levels.front().slab;
    const double height_m = static_cast<double>(receiver.position_m.z);
    const double distance_m = slab.delta_m + height_m;
    if (q == 0 || !(distance_m > 0.0))
        return 0;
    glm::dvec2 texels;
    for (int axis = 0; axis < 2; ++axis)
        texels[axis] = shared::f64::window_texels(static_cast<double>(slab.profile.cells.size()),
                                                  slab.pitch_m[axis], slab.texel_m()[axis],
                                                  slab.delta_m, height_m);
    texels = glm::min(texels, glm::dvec2(slab.texels));
    return shared::f64::mip_level(std::max(texels.x, texels.y), static_cast<double>(q),
                                  static_cast<int>(mips.levels.size()) - 1);
}

std::uint64_t irradiance(const PreparedMips& mips,
                         int q,
                         std::span<const ReceiverF> receivers,
                         std::span<glm::vec3> results,
                         std::span<float> image_y) {
    if (receivers.empty())
        return 0;
    const auto level = static_cast<std::size_t>(level_for(mips, receivers.front(), q));
    return irradiance(mips.levels[level], receivers, results, image_y);
}

}  // namespace nearfield::model
