// SPDX-License-Identifier: Apache-2.0
#include "formats/model/emission.h"

#include "formats/files/error.h"
#include "formats/model/luminaire.h"
#include "formats/model/profile.h"
#include "formats/shared/philox.glsl.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace nearfield::model {
namespace {

// Eight numbers in [0, 1), a function of ray, try and seed.
std::array<double, 8> random_numbers(std::uint64_t index,
                                     std::uint32_t attempt,
                                     std::uint32_t seed) {
    std::array<double, 8> numbers{};
    for (std::uint32_t half = 0; half < 2; ++half) {
        const glm::uvec4 bits =
            shared::philox4x32({static_cast<std::uint32_t>(index),
                                static_cast<std::uint32_t>(index >> 32U), attempt, half},
                               {seed, 0x72617973U});  // "rays": a stream of its own
        for (int k = 0; k < 4; ++k)
            numbers[std::size_t{4} * half + static_cast<std::size_t>(k)] = bits[k] * 0x1p-32;
    }
    return numbers;
}

double texel_luminance(const Slab& slab, int m, std::size_t texel) {
    const float* first = &slab.coeffs[slab.image_offset(0, m) + texel];
    if (slab.channels == 1)
        return *first;
    double y = 0.0;
    for (int c = 0; c < 3; ++c)
        y += kLuminanceRgb[static_cast<std::size_t>(c)] *
             slab.coeffs[slab.image_offset(c, m) + texel];
    return y;
}

glm::dvec3 texel_color(const Slab& slab, int m, std::size_t texel) {
    if (slab.channels == 1)
        return glm::dvec3(1.0);
    glm::dvec3 rgb{0.0};
    for (int c = 0; c < 3; ++c)
        rgb[c] = slab.coeffs[slab.image_offset(c, m) + texel];
    return rgb / luminance(rgb);
}

// The first of rising ends beyond t; entries of no width are never hit.
std::size_t find(const double* begin, const double* end, double t) {
    const auto found = std::upper_bound(begin, end, t);
    // Rounding of t against the last end: the last entry that has a width.
    if (found == end)
        return static_cast<std::size_t>(std::lower_bound(begin, end, *(end - 1)) - begin);
    return static_cast<std::size_t>(found - begin);
}

// int of a0 + a1 x + a2 x^2 from x0 to x, about x0.
double cell_integral(const std::array<double, 3>& a, double x0, double x) {
    const double h = x - x0, c = 0.5 * (x + x0);
    return h * (a[0] + c * (a[1] + c * a[2]) + a[2] * h * h / 12.0);
}

// Where the integral from x0 on is `target`: Newton's steps, and bisection where one would leave
// the bracket, as where a profile touches zero at a cell's end.
double invert_cell(const std::array<double, 3>& a, double x0, double target, double guess) {
    constexpr int kMostSteps = 60;
    constexpr double kClose =
        1e-7;  // of a pitch: after such a step of Newton the error is its square
    double low = x0, high = x0 + 1.0, x = std::clamp(guess, low, high);
    for (int k = 0; k < kMostSteps && high - low > kClose; ++k) {
        const double excess = cell_integral(a, x0, x) - target;
        (excess < 0.0 ? low : high) = x;
        const double newton = x - excess / (a[0] + x * (a[1] + x * a[2]));
        const double next = newton > low && newton < high ? newton : 0.5 * (low + high);
        if (std::abs(next - x) <= kClose)
            return next;
        x = next;
    }
    return x;
}

// Texels whose sum stands in the table: few enough to walk, many enough to keep it small.
constexpr std::size_t kTexelsPerSum = 16;

}  // namespace

Emission::Emission(const LightField& lightfield) : lightfield_(lightfield) {
    double sum = 0.0;
    for (std::size_t s = 0; s < lightfield.slabs.size(); ++s) {
        const Slab& slab = lightfield.slabs[s];
        ProfileCdf cdf;
        const double whole = integral(slab.profile);
        double share = 0.0;
        for (std::size_t c = 0; c < slab.profile.cells.size(); ++c)
            cdf.cells.push_back(share += integral(slab.profile, c) / whole);
        cdf.whole = whole;
        profiles_.push_back(cdf);
        tabulate_guesses(s);
        const double basis_m2 = whole * whole * slab.pitch_m.x * slab.pitch_m.y;
        const double texel_m2 = slab.texel_m().x * slab.texel_m().y;
        const double weight = slab.weighting == Weighting::Irradiance
                                  ? basis_m2 * texel_m2
                                  : basis_m2 * texel_m2 / (slab.delta_m * slab.delta_m);
        for (int m = 0; m < slab.image_count(); ++m) {
            const std::size_t begin = block_ends_.size();
            double image = 0.0;
            for (std::size_t texel = 0; texel < slab.texel_count(); ++texel) {
                image += texel_luminance(slab, m, texel);
                if ((texel + 1) % kTexelsPerSum == 0 || texel + 1 == slab.texel_count())
                    block_ends_.push_back(image);
            }
            if (!(image > 0.0)) {
                block_ends_.resize(begin);
                continue;
            }
            images_.push_back({s, m});
            block_begin_.push_back(begin);
            image_ends_.push_back(sum += weight * image);
        }
    }
    if (images_.empty())
        throw Error{"a light field without light", "coefficients", "one above 0", "none"};
}

glm::dvec2 Emission::draw_s(
    const Image& image, std::size_t index, double xi, glm::dvec2 within, glm::dvec3& color) const {
    const Slab& slab = lightfield_.slabs[image.slab];
    const std::size_t texels = slab.texel_count();
    const double* blocks = &block_ends_[block_begin_[index]];
    const std::size_t block_count = (texels + kTexelsPerSum - 1) / kTexelsPerSum;
    const double t = xi * blocks[block_count - 1];
    const std::size_t block = find(blocks, blocks + block_count, t);
    double running = block == 0 ? 0.0 : blocks[block - 1];
    std::size_t texel = 0;
    for (std::size_t k = block * kTexelsPerSum;
         k < std::min(texels, (block + 1) * kTexelsPerSum) && running <= t; ++k) {
        const double y = texel_luminance(slab, image.m, k);
        if (y > 0.0)
            texel = k;  // the last lit one, where rounding leaves t beyond the block's sum
        running += y;
    }
    color = texel_color(slab, image.m, texel);
    const auto width = static_cast<std::size_t>(slab.texels.x);
    return slab.s_min_m + (glm::dvec2(texel % width, texel / width) + within) * slab.texel_m();
}

double Emission::draw_profile(std::size_t slab, double xi) const {
    const Profile& profile = lightfield_.slabs[slab].profile;
    const ProfileCdf& cdf = profiles_[slab];
    const std::size_t c = find(cdf.cells.data(), cdf.cells.data() + cdf.cells.size(), xi);
    const double before = c == 0 ? 0.0 : cdf.cells[c - 1];
    const double x0 = static_cast<double>(c) - 0.5 * static_cast<double>(cdf.cells.size());
    double guess = x0 + 0.5;
    if (!cdf.guesses.empty()) {
        const double at = xi * static_cast<double>(cdf.guesses.size() - 1);
        const auto k = std::min(static_cast<std::size_t>(at), cdf.guesses.size() - 2);
        guess = std::lerp(cdf.guesses[k], cdf.guesses[k + 1], at - static_cast<double>(k));
    }
    return invert_cell(profile.cells[c], x0, (xi - before) * cdf.whole, guess);
}

// Where Newton's steps start, so that one or two are enough.
void Emission::tabulate_guesses(std::size_t slab) {
    constexpr int kGuesses = 256;
    std::vector<double> guesses;
    for (int k = 0; k <= kGuesses; ++k)
        guesses.push_back(draw_profile(slab, static_cast<double>(k) / kGuesses));
    profiles_[slab].guesses = std::move(guesses);
}

EmittedRay Emission::ray(std::uint64_t index, std::uint32_t seed) const {
    for (std::uint32_t attempt = 0;; ++attempt) {
        const auto xi = random_numbers(index, attempt, seed);
        const std::size_t k = find(image_ends_.data(), image_ends_.data() + image_ends_.size(),
                                   xi[0] * image_ends_.back());
        const Image& image = images_[k];
        const Slab& slab = lightfield_.slabs[image.slab];
        EmittedRay ray;
        ray.slab = image.slab;
        ray.s_m = draw_s(image, k, xi[1], {xi[2], xi[3]}, ray.color);
        const glm::dvec2 x(draw_profile(image.slab, xi[4]), draw_profile(image.slab, xi[5]));
        ray.u_m =
            slab.basis_center_m(image.m % slab.grid.x, image.m / slab.grid.x) + x * slab.pitch_m;
        if (slab.weighting == Weighting::Irradiance)
            return ray;
        const glm::dvec2 tangent = (ray.s_m - ray.u_m) / slab.delta_m;
        const double cos2 = 1.0 / (1.0 + glm::dot(tangent, tangent));
        if (xi[6] < cos2 * cos2)
            return ray;
    }
}

}  // namespace nearfield::model
