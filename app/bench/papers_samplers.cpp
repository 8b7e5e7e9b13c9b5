// SPDX-License-Identifier: Apache-2.0
#include "app/bench/measure.h"
#include "app/bench/papers_run.h"
#include "render/metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <utility>

namespace nearfield::bench {
namespace {

using model::Sampler;

constexpr std::uint32_t kSeed = 1;
constexpr int kTimedFrames = 2;  // the best counts
constexpr const char *kView = "road", *kNearView = "driver", *kFarView = "bird";

// A camera's view of a scene with one lamp; the lamp stays where it is, since the target points at
// it.
struct ViewOfLamp {
    const PapersLamp& named;
    Lamp lamp;
    View view;

    ViewOfLamp(const PapersOptions& options,
               const PapersFindings& findings,
               const std::string& lamp_name,
               const std::string& camera,
               glm::ivec2 size_px)
        : named(lamp_of(findings, lamp_name)),
          lamp(make_lamp(named.lightfield.slabs)),
          view(make_view(make_papers_scene(named, options.folder, 1), camera, size_px, lamp)) {}
};

// As published: Halton's points, the same for every pixel (the paper's section 6.3).
Method published(Sampler sampler, int samples) {
    Method method;
    method.sampling.emplace();
    method.sampling->sampler = sampler;
    method.sampling->samples = samples;
    method.sampling->sequence = model::default_sequence(sampler);
    method.shift = model::Shift::Constant;
    return method;
}

// This project's samplers: points shifted at random from pixel to pixel.
Method shifted(Sampler sampler, int samples) {
    Method method = published(sampler, samples);
    method.shift = model::Shift::Random;
    return method;
}

Method method_of(Sampler sampler, int samples) {
    const bool is_ours = sampler == Sampler::Systematic || sampler == Sampler::Cells;
    return is_ours ? shifted(sampler, samples) : published(sampler, samples);
}

struct Frame {
    std::vector<float> y;
    double time_s = 0;
};

Frame draw_frame(const Target& target, const Method& method, int repeats = kTimedFrames) {
    Frame frame;
    frame.time_s = std::numeric_limits<double>::infinity();
    for (int k = 0; k < repeats; ++k)
        frame.time_s = std::min(frame.time_s, run_pass(target, method, 0, kSeed, frame.y).time_s);
    return frame;
}

// The mean of frames of one sample each: every sample independent of all others.
std::vector<float> draw_independent(const Target& target, Sampler sampler, int samples) {
    std::vector<float> sum(target.count(), 0.0F), y;
    for (int k = 0; k < samples; ++k) {
        run_pass(target, shifted(sampler, 1), static_cast<std::uint32_t>(k), kSeed, y);
        for (std::size_t p = 0; p < y.size(); ++p)
            sum[p] += y[p] / static_cast<float>(samples);
    }
    return sum;
}

std::vector<float> gray(const std::vector<float>& y) {
    std::vector<float> rgb;
    for (const float value : y)
        rgb.insert(rgb.end(), 3, value);
    return rgb;
}

PapersRow compare(const ViewOfLamp& stage,
                  const std::string& figure,
                  const std::string& method,
                  const std::string& setting,
                  int samples,
                  const std::vector<float>& y,
                  const std::vector<float>& reference_y) {
    PapersRow row{figure,
                  stage.named.name,
                  stage.view.camera,
                  "CPU",
                  method,
                  setting,
                  samples,
                  stage.view.target.size,
                  {},
                  {},
                  {},
                  {},
                  {},
                  {},
                  {}};
    row.lab = render::lab_difference(gray(y), gray(reference_y));
    const render::RelativeError error = render::relative_error(y, reference_y);
    row.rms_rel = error.rms;
    row.p95_rel = error.p95;
    row.largest_rel = error.largest;
    return row;
}

// Draws a frame, and adds its row.
Frame add_frame(PapersFindings& findings,
                const ViewOfLamp& stage,
                const std::string& figure,
                const std::string& setting,
                const Method& method,
                int repeats = kTimedFrames) {
    Frame frame = draw_frame(stage.view.target, method, repeats);
    PapersRow row = compare(stage, figure, method.name(), setting, method.size(), frame.y,
                            stage.view.target.truth_y);
    row.time_s = frame.time_s;
    findings.rows.push_back(std::move(row));
    return frame;
}

std::string samples_text(int samples) {
    return samples == 0 ? "exact" : fmt::format("K = {}", samples);
}

Frame add_frame(PapersFindings& findings,
                const ViewOfLamp& stage,
                const std::string& figure,
                const Method& method,
                int repeats = kTimedFrames) {
    return add_frame(findings, stage, figure, samples_text(method.size()), method, repeats);
}

void add_picture(const PapersOptions& options,
                 PapersFindings& findings,
                 const ViewOfLamp& stage,
                 const std::string& figure,
                 const std::string& name,
                 const std::string& caption,
                 const std::vector<float>& y) {
    const Target& target = stage.view.target;
    const std::string file = fmt::format("figure{}_{}.png", figure, name);
    findings.pictures.push_back({figure, file,
                                 write_view((std::filesystem::path(options.folder) / file).string(),
                                            caption, target.size, y, target.truth_y)});
    if (auto error = draw_error(caption + ", error", target.size, y, target.truth_y))
        findings.pictures.push_back({figure, "", std::move(*error)});
}

}  // namespace

void measure_search(const PapersOptions& options, PapersFindings& findings) {
    constexpr int kSamples = 200, kShownDepth = 3;
    const ViewOfLamp stage(options, findings, "9x7", kView, findings.size_px);
    for (const model::Search search : {model::Search::Secant, model::Search::Bisection})
        for (const int depth : {1, 2, kShownDepth, 4, 6, 8, 0}) {
            Method method = published(Sampler::Pdis, kSamples);
            method.sampling->search = search;
            method.sampling->search_steps = depth;
            const std::string name = search == model::Search::Secant ? "secant" : "bisection";
            const std::string steps = depth == 0 ? "to the end" : fmt::format("depth {}", depth);
            const Frame frame =
                add_frame(findings, stage, "5", fmt::format("{}, {}", name, steps), method);
            if (depth == kShownDepth)
                add_picture(options, findings, stage, "5", name,
                            fmt::format("pdis, {}, {}", name, steps), frame.y);
        }
}

void measure_sequences(const PapersOptions& options, PapersFindings& findings) {
    constexpr int kFew = 25;
    const ViewOfLamp stage(options, findings, "5x5", kView, findings.small_px);
    const Target& target = stage.view.target;
    const auto caption = [](const std::string& name, int samples) {
        return fmt::format("{}, {} samples", name, samples);
    };
    for (const int samples : options.quick ? std::vector{kFew, 100} : std::vector{kFew, 100, 400}) {
        for (const model::Sequence sequence :
             {model::Sequence::Halton, model::Sequence::R2, model::Sequence::Fibonacci,
              model::Sequence::Sobol}) {
            Method method = shifted(Sampler::Systematic, samples);
            method.sampling->sequence = sequence;
            const std::string name = model::name_of(sequence);
            const Frame frame = add_frame(findings, stage, "8", name, method);
            if (samples == kFew && sequence == model::Sequence::Halton)
                add_picture(options, findings, stage, "8", name, caption(name, samples), frame.y);
        }
        const std::vector<float> y = draw_independent(target, Sampler::Systematic, samples);
        findings.rows.push_back(
            compare(stage, "8", "systematic", "independent", samples, y, target.truth_y));
        if (samples == kFew)
            add_picture(options, findings, stage, "8", "independent",
                        caption("independent", samples), y);
    }
}

void measure_k_max(const PapersOptions& options, PapersFindings& findings) {
    constexpr int kSamples = 200, kMost = 7;
    const ViewOfLamp stage(options, findings, "9x7", kView, findings.size_px);
    const Frame without =
        add_frame(findings, stage, "9", "no limit", published(Sampler::Pdis, kSamples));
    Method method = published(Sampler::Pdis, kSamples);
    method.sampling->k_max = kMost;
    const std::string setting = fmt::format("K_max {}", kMost);
    const Frame with = add_frame(findings, stage, "9", setting, method);
    findings.rows.push_back(
        compare(stage, "9", "pdis", "between the two", kSamples, with.y, without.y));
    add_picture(options, findings, stage, "9", "no_limit", "pdis, K = 200", without.y);
    add_picture(options, findings, stage, "9", "limit", "pdis, K = 200, K_max 7", with.y);
}

void measure_precomputed(const PapersOptions& options, PapersFindings& findings) {
    const ViewOfLamp stage(options, findings, "9x7", kView, findings.small_px);
    const int most = options.quick ? 6300 : 63000;
    const auto show = [&](const Method& method, int repeats = kTimedFrames) {
        const Frame frame = add_frame(findings, stage, "11", method, repeats);
        add_picture(options, findings, stage, "11",
                    fmt::format("{}_{}", method.name(), method.size()),
                    fmt::format("{}, {}", method.name(), samples_text(method.size())), frame.y);
    };
    show(published(Sampler::Precomputed, most), 1);
    for (const int samples : {63, 1000})
        show(published(Sampler::Pdis, samples));
    for (const int samples : {63, 1000})
        add_frame(findings, stage, "11", shifted(Sampler::Systematic, samples));
    add_frame(findings, stage, "11", Method{});
}

void measure_uniform(const PapersOptions& options, PapersFindings& findings) {
    const ViewOfLamp stage(options, findings, "9x7", kView, findings.size_px);
    const auto show = [&](const Method& method) {
        const Frame frame = add_frame(findings, stage, "12", method);
        add_picture(options, findings, stage, "12",
                    fmt::format("{}_{}", method.name(), method.size()),
                    fmt::format("{}, {}", method.name(), samples_text(method.size())), frame.y);
    };
    show(published(Sampler::Pdis, 252));
    show(published(Sampler::Uniform, 252));
    show(published(Sampler::Uniform, 1008));
    for (const Sampler sampler : {Sampler::Systematic, Sampler::Cells})
        add_frame(findings, stage, "12", shifted(sampler, 252));
    add_frame(findings, stage, "12", Method{});
}

void measure_convergence(const PapersOptions& options, PapersFindings& findings) {
    for (const char* camera : {kNearView, kFarView}) {
        const ViewOfLamp stage(options, findings, "5x5", camera, findings.size_px);
        for (const Sampler sampler : {Sampler::Pdis, Sampler::Systematic})
            for (const int samples : {100, 200, 400}) {
                const Frame frame = add_frame(findings, stage, "13", method_of(sampler, samples));
                if (samples == 200)
                    add_picture(
                        options, findings, stage, "13",
                        fmt::format("{}_{}", camera, model::name_of(sampler)),
                        fmt::format("{}, K = 200, camera {}", model::name_of(sampler), camera),
                        frame.y);
            }
        add_frame(findings, stage, "13", Method{});
    }
}

void measure_samplers(const PapersOptions& options, PapersFindings& findings) {
    constexpr int kShown = 200;
    const ViewOfLamp stage(options, findings, "11x9", kView, findings.size_px);
    findings.exact_s = stage.view.exact_s;
    const Frame exact = add_frame(findings, stage, "all", Method{});
    add_picture(options, findings, stage, "all", "sum", "sum, exact", exact.y);
    for (const Sampler sampler : {Sampler::Uniform, Sampler::Precomputed, Sampler::Pdis,
                                  Sampler::Systematic, Sampler::Cells})
        for (const int samples : {12, 50, kShown, 800}) {
            const Frame frame = add_frame(findings, stage, "all", method_of(sampler, samples));
            if (samples == kShown)
                add_picture(options, findings, stage, "all", model::name_of(sampler),
                            fmt::format("{}, K = 200", model::name_of(sampler)), frame.y);
        }
}

}  // namespace nearfield::bench
