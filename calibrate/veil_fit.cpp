// SPDX-License-Identifier: Apache-2.0
#include "calibrate/veil_fit.h"

#include "calibrate/robust.h"
#include "formats/rig/veil.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace nearfield::calibrate {
namespace {

// Widths from a hundredth of the picture to half of it: narrower is the lens' own blur, wider is
// an even constant.
constexpr int kWidths = 14;
constexpr double kNarrowest = 0.015, kWidest = 0.5;
// Off the board: below this share of the picture's bright parts, and this share of the picture's
// width away from whatever is above it.
constexpr double kDarkShare = 0.02, kAway = 0.02;
constexpr int kLeastAway_px = 6;
constexpr std::size_t kLeastDark = 200;  // pixels of a picture
constexpr int kVeilRounds = 3;           // the veil's own veil: error v^3

// Sums of the regression P = v B + c of one width, constants already taken out view by view.
struct WidthSums {
    double bb = 0, bp = 0, pp = 0;
};

// Pixels that are dark and away from bright ones.
std::vector<std::size_t> dark_pixels(const std::vector<float>& picture, glm::ivec2 size) {
    const float limit = static_cast<float>(kDarkShare) * quantile_of(picture, 0.98);
    const int away = std::max(kLeastAway_px, static_cast<int>(kAway * size.x));
    const auto width = static_cast<std::size_t>(size.x);
    const auto at = [width](int x, int y) {
        return static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x);
    };
    // Bright ones grown by a square, along x, then y.
    std::vector<char> near_x(picture.size()), near(picture.size());
    for (int y = 0; y < size.y; ++y) {
        int last = -away - 1;
        for (int x = 0; x < size.x + away; ++x) {
            if (x < size.x && picture[at(x, y)] > limit)
                last = x;
            if (x - away >= 0 && last >= x - 2 * away)
                near_x[at(x - away, y)] = 1;
        }
    }
    for (int x = 0; x < size.x; ++x) {
        int last = -away - 1;
        for (int y = 0; y < size.y + away; ++y) {
            if (y < size.y && near_x[at(x, y)] != 0)
                last = y;
            if (y - away >= 0 && last >= y - 2 * away)
                near[at(x, y - away)] = 1;
        }
    }
    std::vector<std::size_t> dark;
    for (std::size_t k = 0; k < picture.size(); ++k) {
        if (near[k] == 0)
            dark.push_back(k);
    }
    return dark;
}

// A plane of one color: what was seen, what it is without the veil known so far.
struct VeilPlane {
    std::vector<float> seen, clear;
    glm::ivec2 size{0};
    double variance_dn2 = 1;  // of one dark value
};

void add_plane(VeilPlane plane,
               std::span<const double> widths_px,
               std::span<WidthSums> sums,
               std::size_t& used) {
    const std::vector<std::size_t> dark = dark_pixels(plane.seen, plane.size);
    if (dark.size() < kLeastDark)
        return;
    // What is dark sends nothing: its noise, blurred, would be compared with itself.
    for (const std::size_t k : dark)
        plane.clear[k] = 0.0F;
    const auto n = static_cast<double>(dark.size());
    double mean_p = 0;
    for (const std::size_t k : dark)
        mean_p += plane.seen[k] / n;
    for (std::size_t w = 0; w < widths_px.size(); ++w) {
        const std::vector<float> veil = rig::wide_blur(plane.clear, plane.size, widths_px[w]);
        double mean_b = 0;
        for (const std::size_t k : dark)
            mean_b += veil[k] / n;
        for (const std::size_t k : dark) {
            const double b = veil[k] - mean_b, p = plane.seen[k] - mean_p;
            sums[w].bb += b * b / plane.variance_dn2;
            sums[w].bp += b * p / plane.variance_dn2;
            sums[w].pp += p * p / plane.variance_dn2;
        }
    }
    used += dark.size() - 1;
}

// Above black alone: darks hold what room light the screen sends, which boards do not see, and the
// regression's constant takes dark current.
std::vector<float> above_black(const capture::FrameRecord& record,
                               const DarkResult& dark,
                               const FrameReader& read) {
    const capture::Frame frame = read(record);
    std::vector<float> net(frame.values.size());
    for (std::size_t k = 0; k < net.size(); ++k) {
        net[k] = static_cast<float>(frame.values[k]) - dark.black_dn[k];
        if (dark.is_hot[k] != 0.0F && k > 1)
            net[k] = net[k - 1];
    }
    return net;
}

// The minimum of chi-square over ln(width), and its curvature: sigma is where it rises by 1.
void find_width(const std::vector<VeilPoint>& points, VeilResult& result) {
    std::size_t best = 0;
    for (std::size_t k = 1; k < points.size(); ++k)
        best = points[k].chi2 < points[best].chi2 ? k : best;
    result.chi2 = points[best].chi2;
    result.share = points[best].share;
    result.sigma_px = points[best].sigma_px;
    if (best == 0 || best + 1 == points.size())
        return;
    const double below = points[best - 1].chi2 - points[best].chi2;
    const double above = points[best + 1].chi2 - points[best].chi2;
    const double step = std::log(points[best + 1].sigma_px / points[best].sigma_px);
    const double shift = 0.5 * (below - above) / (below + above);
    result.sigma_px *= std::exp(shift * step);
    const double curvature = (below + above) / (step * step);
    const double inflation = std::max(1.0, result.chi2 / static_cast<double>(result.pixels));
    result.sigma_sigma_px = result.sigma_px * std::sqrt(2.0 * inflation / curvature);
    // The share along the ladder, quadratically.
    const double rise = 0.5 * (points[best + 1].share - points[best - 1].share);
    const double bend =
        0.5 * (points[best + 1].share + points[best - 1].share) - points[best].share;
    result.share += shift * (rise + shift * bend);
    result.chi2 -= 0.25 * (below - above) * shift;
    const double share_by_width = rise / step;  // moves with the width's error
    result.share_sigma =
        std::hypot(result.share_sigma, share_by_width * result.sigma_sigma_px / result.sigma_px);
}

VeilResult fit_round(std::span<const capture::FrameRecord* const> frames,
                     const PixelLayout& layout,
                     const DarkResult& dark,
                     const rig::Radiometry& radiometry,
                     const FrameReader& read,
                     const VeilResult& before) {
    const rig::Interleave interleave = rig::interleave_of(layout.mosaic);
    std::vector<double> widths_px;
    widths_px.reserve(kWidths);
    for (int k = 0; k < kWidths; ++k)
        widths_px.push_back(layout.size_px.x * kNarrowest *
                            std::pow(kWidest / kNarrowest, double(k) / (kWidths - 1)));
    std::vector<double> plane_widths_px;
    plane_widths_px.reserve(kWidths);
    for (const double width : widths_px)
        plane_widths_px.push_back(width / interleave.step.x);
    std::vector<WidthSums> sums(widths_px.size());
    VeilResult result;
    for (const capture::FrameRecord* record : frames) {
        const std::vector<float> seen = above_black(*record, dark, read);
        const std::vector<float> clear =
            rig::remove_veil(seen, layout.size_px, layout.mosaic,
                             std::clamp(before.share, 0.0, 0.4), before.sigma_px);
        const double dark_dn = dark.black_sigma_dn;
        for (int p = 0; p < interleave.planes(); ++p) {
            VeilPlane plane;
            plane.size = interleave.size_px(layout.size_px, p);
            plane.seen = interleave.plane_of(seen, layout.size_px, p);
            plane.clear = interleave.plane_of(clear, layout.size_px, p);
            plane.variance_dn2 = std::max(
                radiometry.read_noise_dn * radiometry.read_noise_dn + dark_dn * dark_dn, 1e-12);
            add_plane(std::move(plane), plane_widths_px, sums, result.pixels);
        }
    }
    if (result.pixels == 0)
        return result;
    for (std::size_t w = 0; w < sums.size(); ++w) {
        const double share = sums[w].bp / sums[w].bb;
        result.points.push_back({widths_px[w], share, sums[w].pp - share * sums[w].bp});
    }
    std::size_t best = 0;
    for (std::size_t w = 1; w < sums.size(); ++w)
        best = result.points[w].chi2 < result.points[best].chi2 ? w : best;
    const double inflation =
        std::max(1.0, result.points[best].chi2 / static_cast<double>(result.pixels));
    result.share_sigma = std::sqrt(inflation / sums[best].bb);
    find_width(result.points, result);
    constexpr double kSignificant = 5.0;
    result.is_significant = result.share > kSignificant * result.share_sigma;
    return result;
}

}  // namespace

VeilResult veil_of_targets(std::span<const capture::FrameRecord* const> frames,
                           const PixelLayout& layout,
                           const DarkResult& dark,
                           const rig::Radiometry& radiometry,
                           const FrameReader& read) {
    VeilResult result;
    result.sigma_px = layout.size_px.x * kNarrowest;
    for (int round = 0; round < kVeilRounds; ++round) {
        result = fit_round(frames, layout, dark, radiometry, read, result);
        if (result.pixels == 0)
            break;
    }
    return result;
}

}  // namespace nearfield::calibrate
