// SPDX-License-Identifier: Apache-2.0
#include "calibrate/stray.h"

#include "calibrate/robust.h"
#include "formats/model/overlap.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nearfield::calibrate {
namespace {

constexpr int kStrayBlock_px = 8;  // averaged, so that noise does not look like darkness
constexpr double kDarkestShare = 0.05;
constexpr float kSeesScreen = 0.02F;

// The mean of a block's usable pixels; not a number where there is none.
float block_mean(const std::vector<float>& light, const PixelLayout& layout, glm::ivec2 first) {
    const glm::ivec2 end = glm::min(first + kStrayBlock_px, layout.size_px);
    double sum = 0, count = 0;
    for (int y = first.y; y < end.y; ++y) {
        for (int x = first.x; x < end.x; ++x) {
            const float value = light[layout.value_at(x, y)];
            if (std::isnan(value))
                continue;
            sum += value;
            count += 1.0;
        }
    }
    return count > 0.0 ? static_cast<float>(sum / count) : std::numeric_limits<float>::quiet_NaN();
}

std::vector<float> block_means(const std::vector<float>& light, const PixelLayout& layout) {
    std::vector<float> means;
    for (int top = 0; top < layout.size_px.y; top += kStrayBlock_px) {
        for (int left = 0; left < layout.size_px.x; left += kStrayBlock_px)
            means.push_back(block_mean(light, layout, {left, top}));
    }
    return means;
}

double mean_of_all(const std::vector<float>& values) {
    double sum = 0, count = 0;
    for (const float value : values) {
        sum += std::isnan(value) ? 0.0 : value;
        count += std::isnan(value) ? 0.0 : 1.0;
    }
    return count > 0.0 ? sum / count : 0.0;
}

// The least light that a block ever sees, over what is held back then; of blocks that see the
// screen, since another position lights them.
double beside_bound(const std::vector<std::vector<float>>& blocks,
                    const std::vector<double>& held_back) {
    std::vector<float> most(blocks[0].size(), 0.0F), least(blocks[0].size(), 1e30F);
    for (std::size_t m = 0; m < blocks.size(); ++m) {
        for (std::size_t b = 0; b < most.size(); ++b) {
            if (std::isnan(blocks[m][b]) || held_back[m] <= 0.0)
                continue;
            most[b] = std::max(most[b], blocks[m][b]);
            least[b] = std::min(least[b], blocks[m][b] / static_cast<float>(held_back[m]));
        }
    }
    const float brightest = *std::max_element(most.begin(), most.end());
    std::vector<float> seen;
    for (std::size_t b = 0; b < most.size(); ++b) {
        if (most[b] > kSeesScreen * brightest && least[b] < 1e30F)
            seen.push_back(least[b]);
    }
    return std::max(0.0F, quantile_of(seen, kDarkestShare));
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
    std::vector<std::vector<float>> blocks;
    std::vector<double> held_back;
    double open = 0, longest_s = 0;
    // All positions add up to the open lamp times what neighboring profiles add up to, and the
    // peak.
    const double overlap = model::overlap(*filter) * model::overlap(*filter);
    for (const Bracket& bracket : brackets) {
        const auto light = [&](const capture::FrameRecord& record) {
            return block_means(light_of(read(record), record, layout, radiometry, maps), layout);
        };
        blocks.push_back(light(*bracket.back()));
        const double mean = mean_of_all(light(*bracket.front()));
        held_back.push_back(-mean);
        open += mean / (filter_peak * overlap);
        longest_s = std::max(longest_s, bracket.back()->shot.exposure_us * 1e-6);
    }
    for (double& one : held_back)
        one += open;
    // The least of several noisy values lies low: by less than three sigma of a block.
    const double block_sigma = std::hypot(radiometry.read_noise_dn, dark.sigma_dn(longest_s)) /
                               (longest_s * kStrayBlock_px);
    stray.beside_bound = beside_bound(blocks, held_back) + 3.0 * block_sigma / open;
    stray.has_beside_bound = true;
    return stray;
}

}  // namespace nearfield::calibrate
