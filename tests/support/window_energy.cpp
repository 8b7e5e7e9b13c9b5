// SPDX-License-Identifier: Apache-2.0
#include "tests/support/window_energy.h"

#include <algorithm>
#include <cmath>

namespace nearfield::support {
namespace {

double luminance(const Slab& slab, int image, int i, int j) {
    const std::size_t at = static_cast<std::size_t>(j) * static_cast<std::size_t>(slab.texels.x) +
                           static_cast<std::size_t>(i);
    if (slab.channels == 1)
        return slab.coeffs[slab.image_offset(0, image) + at];
    return 0.2126 * slab.coeffs[slab.image_offset(0, image) + at] +
           0.7152 * slab.coeffs[slab.image_offset(1, image) + at] +
           0.0722 * slab.coeffs[slab.image_offset(2, image) + at];
}

// Sum of C times area on U over the parts whose cells lie in [first, first + count) along both
// axes.
double energy(
    const Slab& slab, const model::ReceiverF& receiver, int image, glm::ivec2 first, int count) {
    const auto within = [&](const AxisPart& part, int cell) {
        return part.cell >= cell && part.cell < cell + count;
    };
    const std::vector<AxisPart> x = axis_parts(slab, receiver, 0),
                                y = axis_parts(slab, receiver, 1);
    double sum = 0.0;
    for (const AxisPart& py : y)
        for (const AxisPart& px : x)
            if (within(px, first.x) && within(py, first.y))
                sum += luminance(slab, image, px.texel, py.texel) * px.width_u_m() * py.width_u_m();
    const double distance_m = slab.delta_m + static_cast<double>(receiver.position_m.z);
    const double scale =
        slab.weighting == Weighting::Irradiance ? slab.delta_m * slab.delta_m : 1.0;
    return sum * scale / (distance_m * distance_m);
}

double mean(const Profile& profile, int cell) {
    const double middle = cell + 0.5 - 0.5 * static_cast<double>(profile.cells.size());
    const auto& [a0, a1, a2] = profile.cells[static_cast<std::size_t>(cell)];
    // int of a0 + a1 x + a2 x^2 over [middle - 1/2, middle + 1/2]
    return a0 + a1 * middle +
           a2 * (std::pow(middle + 0.5, 3.0) - std::pow(middle - 0.5, 3.0)) / 3.0;
}

}  // namespace

std::vector<AxisPart> axis_parts(const Slab& slab, const model::ReceiverF& receiver, int axis) {
    const double p = receiver.position_m[axis], height = receiver.position_m.z;
    const double delta = slab.delta_m, n = static_cast<double>(slab.profile.cells.size());
    const double s_min = slab.s_min_m[axis], texel = slab.texel_m()[axis];
    const double pitch = slab.pitch_m[axis];
    const double u_first = slab.basis_center_m(0, 0)[axis] - 0.5 * n * pitch;
    const double u_last = u_first + (slab.grid[axis] - 1 + n) * pitch;
    const auto u_of_s = [&](double s) { return s + (s - p) * (delta / height); };

    std::vector<double> cuts = {u_first, u_last};
    for (int c = 1; c < slab.grid[axis] - 1 + static_cast<int>(n); ++c)
        cuts.push_back(u_first + c * pitch);
    if (height != 0.0)
        for (int i = 0; i <= slab.texels[axis]; ++i)
            cuts.push_back(u_of_s(s_min + i * texel));
    std::sort(cuts.begin(), cuts.end());
    std::vector<AxisPart> parts;
    for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
        const double middle = 0.5 * (cuts[k] + cuts[k + 1]);
        const double s = middle + (p - middle) * (delta / (delta + height));
        const double at = std::floor((s - s_min) / texel);
        if (!(cuts[k + 1] > cuts[k] && at >= 0.0 && at < slab.texels[axis]))
            continue;
        parts.push_back({cuts[k], cuts[k + 1], static_cast<int>(at),
                         static_cast<int>(std::floor((middle - u_first) / pitch))});
    }
    return parts;
}

double support_energy(const Slab& slab, const model::ReceiverF& receiver, int image) {
    return energy(slab, receiver, image, {image % slab.grid.x, image / slab.grid.x},
                  static_cast<int>(slab.profile.cells.size()));
}

double cell_energy(const Slab& slab, const model::ReceiverF& receiver, int image, glm::ivec2 cell) {
    const glm::ivec2 grid(image % slab.grid.x, image / slab.grid.x);
    return energy(slab, receiver, image, grid + cell, 1) * mean(slab.profile, cell.x) *
           mean(slab.profile, cell.y);
}

}  // namespace nearfield::support
