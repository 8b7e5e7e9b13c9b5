// SPDX-License-Identifier: Apache-2.0
#include "app/bench/measure.h"

#include "formats/files/provenance.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <utility>

namespace nearfield::bench {
namespace {

// Neighbors that the sum takes together, as the renderer does.
constexpr std::size_t kBatch = 16;
// Passes are repeated until they took so long together: time of short ones is noise otherwise.
constexpr double kLeastTimed_s = 0.05;
constexpr int kMostTimedPasses = 200;
constexpr int kBlock = 4;

struct Scratch {
    std::vector<model::SamplingView> views;
    std::vector<model::LightSample> samples;
    std::vector<model::ReceiverF> batch;
    std::vector<glm::vec3> light;
    std::uint64_t reads = 0;
};
using Scratches = tbb::enumerable_thread_specific<Scratch>;

float luminance(glm::vec3 rgb) {
    return static_cast<float>(model::luminance(glm::dvec3(rgb)));
}

std::span<const model::ReceiverF> receiver_in_slabs(const Target& target, std::size_t receiver) {
    const std::size_t slabs = target.lamp->slabs.size();
    return std::span(target.receivers).subspan(receiver * slabs, slabs);
}

glm::uvec2 pixel(const Target& target, std::size_t receiver) {
    const auto k = static_cast<unsigned>(receiver);
    const auto width = static_cast<unsigned>(target.size.x);
    return width == 0 ? glm::uvec2(k, 0) : glm::uvec2(k % width, k / width);
}

void sum_batch(const Target& target,
               int q,
               std::size_t first,
               std::size_t end,
               Scratch& scratch,
               std::vector<float>& y) {
    const Lamp& lamp = *target.lamp;
    const std::size_t slabs = lamp.mips.size();
    scratch.light.resize(end - first);
    std::fill(y.begin() + static_cast<std::ptrdiff_t>(first),
              y.begin() + static_cast<std::ptrdiff_t>(end), 0.0F);
    for (std::size_t s = 0; s < slabs; ++s) {
        scratch.batch.clear();
        for (std::size_t k = first; k < end; ++k)
            scratch.batch.push_back(target.receivers[k * slabs + s]);
        // Two multiply-adds a texel.
        scratch.reads += model::irradiance(lamp.mips[s], q, scratch.batch, scratch.light) / 2;
        for (std::size_t k = first; k < end; ++k)
            y[k] += luminance(scratch.light[k - first]);
    }
}

void sample_receiver(const Target& target,
                     const Method& method,
                     std::size_t k,
                     glm::vec2 shift,
                     Scratch& scratch,
                     std::vector<float>& y) {
    scratch.views.resize(target.lamp->slabs.size());
    for (model::SamplingView& view : scratch.views)
        view.reads = 0;
    y[k] = luminance(model::irradiance_by_sampler(target.lamp->slabs, receiver_in_slabs(target, k),
                                                  *method.sampling, shift, scratch.views,
                                                  scratch.samples));
    for (const model::SamplingView& view : scratch.views)
        scratch.reads += view.reads;
}

Pass run_pass(const Target& target,
              const Method& method,
              std::uint32_t pass,
              std::uint32_t seed,
              std::vector<float>& y,
              Scratches& scratches) {
    for (Scratch& scratch : scratches)
        scratch.reads = 0;
    const std::size_t batch = method.sampling || target.size.x == 0 ? 1 : kBatch;
    const std::size_t batches = (target.count() + batch - 1) / batch;
    const double start_s = now_s();
    tbb::parallel_for(std::size_t{0}, batches, [&](std::size_t b) {
        Scratch& scratch = scratches.local();
        const std::size_t first = b * batch, end = std::min(target.count(), first + batch);
        if (!method.sampling)
            return sum_batch(target, method.q, first, end, scratch, y);
        for (std::size_t k = first; k < end; ++k)
            sample_receiver(target, method, k,
                            model::shift_of(method.shift, pixel(target, k), pass, seed), scratch,
                            y);
    });
    Pass result{now_s() - start_s, 0};
    for (const Scratch& scratch : scratches)
        result.reads += scratch.reads;
    return result;
}

// What comes before the first sample is drawn.
double look_once_s(const Target& target, const Method& method, Scratches& scratches) {
    const double start_s = now_s();
    tbb::parallel_for(std::size_t{0}, target.count(), [&](std::size_t k) {
        std::vector<model::SamplingView>& views = scratches.local().views;
        const auto receivers = receiver_in_slabs(target, k);
        views.resize(receivers.size());
        for (std::size_t s = 0; s < receivers.size(); ++s)
            model::look(target.lamp->slabs[s], receivers[s], *method.sampling, views[s]);
    });
    return now_s() - start_s;
}

// The best of many runs that together take long enough.
template <typename Run>
double best_s(double best_so_far_s, double spent_s, const Run& run) {
    for (int k = 0; k < kMostTimedPasses && spent_s < kLeastTimed_s; ++k) {
        const double time_s = run();
        best_so_far_s = std::min(best_so_far_s, time_s);
        spent_s += time_s;
    }
    return best_so_far_s;
}

// Means over blocks of receivers on a grid.
std::vector<float> block_means(const std::vector<float>& y, glm::ivec2 size) {
    std::vector<float> means;
    for (int row = 0; row + kBlock <= size.y; row += kBlock)
        for (int column = 0; column + kBlock <= size.x; column += kBlock) {
            float sum = 0.0F;
            for (int k = 0; k < kBlock * kBlock; ++k)
                sum +=
                    y[static_cast<std::size_t>((row + k / kBlock) * size.x + column + k % kBlock)];
            means.push_back(sum / (kBlock * kBlock));
        }
    return means;
}

// Values and truths of all passes, one behind the other.
struct Pooled {
    std::vector<float> values, truths;

    void add(const std::vector<float>& y, const std::vector<float>& truth) {
        values.insert(values.end(), y.begin(), y.end());
        truths.insert(truths.end(), truth.begin(), truth.end());
    }
    render::RelativeError error() const { return render::relative_error(values, truths); }
};

}  // namespace

std::string Method::name() const {
    return sampling ? model::name_of(sampling->sampler) : "sum";
}

Pass run_pass(const Target& target,
              const Method& method,
              std::uint32_t pass,
              std::uint32_t seed,
              std::vector<float>& y) {
    Scratches scratches;
    y.resize(target.count());
    return run_pass(target, method, pass, seed, y, scratches);
}

Result measure(const Target& target, const Case& a_case, std::uint32_t seed) {
    Result result;
    result.of = a_case;
    Scratches scratches;
    std::vector<float> y(target.count());
    const bool is_grid = target.size.x > 0;
    const std::vector<float> truth_blocks =
        is_grid ? block_means(target.truth_y, target.size) : std::vector<float>();
    Pooled pooled, blocks;
    double best = std::numeric_limits<double>::infinity(), spent_s = 0.0;
    result.rms_low = best;
    for (int k = 0; k < a_case.passes; ++k) {
        const Pass pass =
            run_pass(target, a_case.method, static_cast<std::uint32_t>(k), seed, y, scratches);
        best = std::min(best, pass.time_s);
        spent_s += pass.time_s;
        result.reads += static_cast<double>(pass.reads);
        const double rms = render::relative_error(y, target.truth_y).rms;
        result.rms_low = std::min(result.rms_low, rms);
        result.rms_high = std::max(result.rms_high, rms);
        pooled.add(y, target.truth_y);
        if (is_grid)
            blocks.add(block_means(y, target.size), truth_blocks);
    }
    best = best_s(best, spent_s,
                  [&] { return run_pass(target, a_case.method, 0, seed, y, scratches).time_s; });
    const auto count = static_cast<double>(target.count());
    result.error = pooled.error();
    if (is_grid)
        result.block_rms = blocks.error().rms;
    result.reads /= a_case.passes * count;
    result.time_us = 1e6 * best / count;
    if (a_case.method.sampling) {
        const double look_s = best_s(std::numeric_limits<double>::infinity(), 0.0,
                                     [&] { return look_once_s(target, a_case.method, scratches); });
        result.look_us = std::min(1e6 * look_s / count, result.time_us);
    }
    return result;
}

}  // namespace nearfield::bench
