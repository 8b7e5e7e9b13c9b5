// SPDX-License-Identifier: Apache-2.0
#include "formats/proxies/projectors.h"

#include "formats/model/luminaire.h"
#include "formats/model/window_sum.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace nearfield::proxies {
namespace {

// One basis function's windows on S along an axis, a pixel each.
std::vector<model::AxisWindow> pixel_windows(
    const Slab& slab, int axis, int basis, double tangent, int pixels) {
    std::vector<model::AxisWindow> windows;
    windows.reserve(static_cast<std::size_t>(pixels));
    for (int i = 0; i < pixels; ++i) {
        model::AxisWindows all =
            model::make_far_windows(slab, axis, tangent * (2 * (i + 0.5) / pixels - 1));
        windows.push_back(std::move(all.of_basis[static_cast<std::size_t>(basis)]));
    }
    return windows;
}

bool is_lit(const Slab& slab, int m) {
    for (int c = 0; c < slab.channels; ++c) {
        const auto first =
            slab.coeffs.begin() + static_cast<std::ptrdiff_t>(slab.image_offset(c, m));
        if (std::any_of(first, first + static_cast<std::ptrdiff_t>(slab.texel_count()),
                        [](float value) { return value > 0; }))
            return true;
    }
    return false;
}

// The picture's place: about the basis function's center, wide enough for all of S seen from
// anywhere in its support.
Projector frame_of(const Slab& slab, int m) {
    const glm::dvec2 center_m = slab.basis_center_m(m % slab.grid.x, m / slab.grid.x);
    const glm::dvec2 half_support_m =
        0.5 * static_cast<double>(slab.profile.cells.size()) * slab.pitch_m;
    const glm::dvec2 half_m =
        glm::max(slab.s_max_m - center_m, center_m - slab.s_min_m) + half_support_m;
    Projector projector;
    projector.luminaire_from_projector = slab.luminaire_from_slab;
    projector.luminaire_from_projector.translation_m +=
        slab.luminaire_from_slab.rotation * glm::dvec3(center_m, -slab.delta_m);
    // Renderers take a picture's sides from its pixels: these are square.
    const double pixel_m = std::min(slab.texel_m().x, slab.texel_m().y);
    projector.size_px = glm::max(glm::ivec2(glm::ceil(2.0 * half_m / pixel_m)), 1);
    projector.tangent = 0.5 * pixel_m * glm::dvec2(projector.size_px) / slab.delta_m;
    projector.channels = slab.channels;
    return projector;
}

// Irradiance at z = 1 is I cos^3: int int C Phi times delta^2 (irradiance weighting) or cos^4.
Projector projector_of(const Slab& slab, int m) {
    Projector projector = frame_of(slab, m);
    const glm::ivec2 size = projector.size_px;
    const auto wx = pixel_windows(slab, 0, m % slab.grid.x, projector.tangent.x, size.x);
    const auto wy = pixel_windows(slab, 1, m / slab.grid.x, projector.tangent.y, size.y);
    projector.irradiance.resize(static_cast<std::size_t>(slab.channels) *
                                static_cast<std::size_t>(size.x) *
                                static_cast<std::size_t>(size.y));
    std::size_t at = 0;
    for (int c = 0; c < slab.channels; ++c) {
        const float* image = slab.coeffs.data() + slab.image_offset(c, m);
        for (const model::AxisWindow& y : wy)
            for (const model::AxisWindow& x : wx) {
                double sum = 0;
                for (int j = 0; j < y.range.count; ++j) {
                    const float* row =
                        image + static_cast<std::ptrdiff_t>(y.range.first + j) * slab.texels.x;
                    double of_row = 0;
                    for (int i = 0; i < x.range.count; ++i)
                        of_row += static_cast<double>(row[x.range.first + i]) *
                                  x.m0[static_cast<std::size_t>(i)];
                    sum += of_row * y.m0[static_cast<std::size_t>(j)];
                }
                const double px = projector.tangent.x *
                                  (2 * (static_cast<double>(&x - wx.data()) + 0.5) / size.x - 1);
                const double py = projector.tangent.y *
                                  (2 * (static_cast<double>(&y - wy.data()) + 0.5) / size.y - 1);
                const double secant2 = 1 + px * px + py * py;
                projector.irradiance[at++] = static_cast<float>(
                    sum * (slab.weighting == Weighting::Irradiance ? slab.delta_m * slab.delta_m
                                                                   : 1 / (secant2 * secant2)));
            }
    }
    return projector;
}

// At normal incidence a point at (x, y, z) gets irradiance(x / z, y / z) / (z^2 cos).
double irradiance_of(const Projector& projector, const model::Receiver& receiver) {
    const glm::dmat3 to_projector = glm::transpose(projector.luminaire_from_projector.rotation);
    const glm::dvec3 p =
        to_projector * (receiver.position_m - projector.luminaire_from_projector.translation_m);
    if (!(p.z > 0))
        return 0;
    const glm::dvec2 place =
        0.5 * (glm::dvec2(p) / (p.z * projector.tangent) + 1.0) * glm::dvec2(projector.size_px);
    const glm::ivec2 pixel(glm::floor(place));
    if (!(place.x >= 0 && place.y >= 0 && pixel.x < projector.size_px.x &&
          pixel.y < projector.size_px.y))
        return 0;
    const auto count = static_cast<std::size_t>(projector.size_px.x) *
                       static_cast<std::size_t>(projector.size_px.y);
    const auto index =
        static_cast<std::size_t>(pixel.y) * static_cast<std::size_t>(projector.size_px.x) +
        static_cast<std::size_t>(pixel.x);
    double value = 0;
    for (std::size_t c = 0; c < static_cast<std::size_t>(projector.channels); ++c)
        value += (projector.channels == 1 ? 1 : kLuminanceRgb[c]) *
                 static_cast<double>(projector.irradiance[c * count + index]);
    const double distance = glm::length(p);
    const double facing = -glm::dot(to_projector * receiver.normal, p) / distance;
    return facing > 0 ? value * distance / (p.z * p.z * p.z) * facing : 0;
}

}  // namespace

std::vector<Projector> projectors_of(const LightField& lightfield) {
    std::vector<std::pair<const Slab*, int>> images;
    for (const Slab& slab : lightfield.slabs)
        for (int m = 0; m < slab.image_count(); ++m)
            if (is_lit(slab, m))
                images.emplace_back(&slab, m);
    std::vector<Projector> projectors(images.size());
    tbb::parallel_for(std::size_t{0}, images.size(), [&](std::size_t k) {
        projectors[k] = projector_of(*images[k].first, images[k].second);
    });
    return projectors;
}

double irradiance(const std::vector<Projector>& projectors, const model::Receiver& receiver) {
    double sum = 0;
    for (const Projector& projector : projectors)
        sum += irradiance_of(projector, receiver);
    return sum;
}

}  // namespace nearfield::proxies
