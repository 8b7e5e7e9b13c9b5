// SPDX-License-Identifier: Apache-2.0
#include "calibrate/stray.h"

#include "calibrate/robust.h"
#include "formats/model/profile.h"

#include <algorithm>
#include <cmath>

namespace nearfield::calibrate {
namespace {

constexpr int kStrayBlock_px = 8;     // averaged, so that noise does not look like darkness
constexpr double kDarkestShare = 0.05;

// Means of blocks, those without a usable pixel left out.
std::vector<float> block_means(const std::vector<float>& light, const PixelLayout& layout) {
    std::vector<float> means;
    for (int top = 0; top < layout.size_px.y; top += kStrayBlock_px) {
        for (int left = 0; left < layout.size_px.x; left += kStrayBlock_px) {
            double sum = 0, count = 0;
            for (int y = top; y < std::min(top + kStrayBlock_px, layout.size_px.y); ++y) {
                for (int x = left; x < std::min(left + kStrayBlock_px, layout.size_px.x); ++x) {
                    const float value = light[layout.value_at(x, y)];
                    if (std::isnan(value))
                        continue;
                    sum += value;
                    count += 1.0;
                }
            }
            if (count > 0.0)
                means.push_back(static_cast<float>(sum / count));
        }
    }
    return means;
}

double mean_of_all(const std::vector<float>& values) {
    double sum = 0;
    for (const float value : values)
        sum += value;
    return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

void measure_room(std::span<const ExposureGroup> darks, StrayResult& stray) {
    double sum = 0, squares = 0, count = 0;
    for (const ExposureGroup& group : darks) {
        for (const capture::FrameRecord* record : group.frames) {
            if (!record->reading_lx)
                continue;
            sum += *record->reading_lx;
            squares += *record->reading_lx * *record->reading_lx;
            count += 1.0;
        }
    }
    if (count < 2.0)
        return;
    stray.is_room_measured = true;
    stray.room_lx = sum / count;
    stray.room_sigma_lx =
        std::sqrt(std::max(0.0, squares - sum * sum / count) / (count * (count - 1.0)));
}

}  // namespace

StrayResult stray_of(std::span<const Bracket> brackets,
                     std::span<const ExposureGroup> darks,
                     const PixelLayout& layout,
                     const DarkResult& dark,
                     const rig::Radiometry& radiometry,
                     const rig::Maps& maps,
                     double flat_rate_dn_per_s,
                     const std::optional<Profile>& filter,
                     double filter_peak,
                     const FrameReader& read) {
    StrayResult stray;
    measure_room(darks, stray);
    const double median_rate = std::max(0.0, dark.median_rate_dn_per_s);
    stray.room_bound_lx = median_rate * radiometry.scale_lx_s_per_dn;
    stray.flat_bound_rel = flat_rate_dn_per_s > 0.0 ? median_rate / flat_rate_dn_per_s : 0.0;
    if (!filter || brackets.size() < 2)
        return stray;
    std::vector<double> low, mean;
    for (const Bracket& bracket : brackets) {
        const auto light = [&](const capture::FrameRecord& record) {
            return block_means(
                light_of(read(record), record.shot.exposure_us, layout, radiometry, maps), layout);
        };
        low.push_back(quantile_of(light(*bracket.back()), kDarkestShare));
        mean.push_back(mean_of_all(light(*bracket.front())));
    }
    // All positions add up to the open lamp times what neighboring profiles add up to.
    double overlap = 0;
    const int reach = static_cast<int>(filter->cells.size());
    for (int k = -reach; k <= reach; ++k)
        overlap += model::eval(*filter, k);
    double open = 0;
    for (const double one : mean)
        open += one / (filter_peak * overlap * overlap);
    for (std::size_t k = 0; k < mean.size(); ++k) {
        if (open - mean[k] <= 0.0)
            continue;
        const double bound = std::max(0.0, low[k]) / (open - mean[k]);
        stray.beside_bound = stray.has_beside_bound ? std::min(stray.beside_bound, bound) : bound;
        stray.has_beside_bound = true;
    }
    return stray;
}

}  // namespace nearfield::calibrate
