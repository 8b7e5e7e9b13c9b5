// SPDX-License-Identifier: Apache-2.0
// What a sample costs on one thread: looking at every window of the 11 x 9 x 256^2 reference lamp,
// drawing, building tables, evaluating and sampling BRDFs. Beside each the floats it reads from
// tables and texels a second, and their share of what the machine reads in order from its
// third-level cache: these reads are scattered, a line each. Run: sampler_bench
// [--benchmark_filter=...].
#include "formats/model/sampler.h"
#include "formats/model/tables.h"
#include "formats/shared/brdf.glsl.h"
#include "sample_data/reference_lamp.h"
#include "tests/bench/roofline.h"

#include <tbb/global_control.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace nearfield::bench {
namespace {

constexpr std::size_t kThirdLevelBytes = std::size_t{8} << 20;

double ordered_reads_s() {
    static const double reads_s = load_roof(Reading::Aligned, kThirdLevelBytes, 1);
    return reads_s;
}

void report_reads(benchmark::State& state, std::uint64_t reads) {
    state.counters["reads"] =
        benchmark::Counter(static_cast<double>(reads), benchmark::Counter::kIsRate);
    state.counters["load_roof_share"] = benchmark::Counter(
        static_cast<double>(reads) / ordered_reads_s(), benchmark::Counter::kIsRate);
}

// The lamp, its receivers, and the views of them.
struct Scene {
    std::vector<model::SamplingSlab> slabs;
    std::vector<model::ReceiverF> receivers;
    std::vector<model::SamplingView> views;  // [receiver]
};

Scene make_scene() {
    Scene scene;
    scene.slabs.push_back(model::prepare_sampling(sample_data::make_reference_lamp().slabs[0]));
    for (const model::Receiver& receiver : sample_data::reference_receivers())
        scene.receivers.push_back({glm::vec3(receiver.position_m), glm::vec3(receiver.normal)});
    scene.views.resize(scene.receivers.size());
    return scene;
}

Scene& scene() {
    static Scene made = make_scene();
    return made;
}

std::uint64_t reads_of(const Scene& lit) {
    std::uint64_t reads = 0;
    for (const model::SamplingView& view : lit.views)
        reads += view.reads;
    return reads;
}

void forget_reads(Scene& lit) {
    for (model::SamplingView& view : lit.views)
        view.reads = 0;
}

model::SamplerOptions options_of(model::Sampler sampler) {
    model::SamplerOptions options;
    options.sampler = sampler;
    options.sequence = model::default_sequence(sampler);
    return options;
}

void look(benchmark::State& state, model::Sampler sampler) {
    const model::SamplerOptions options = options_of(sampler);
    Scene& lit = scene();
    forget_reads(lit);
    std::size_t k = 0;
    for (auto _ : state) {
        model::look(lit.slabs[0], lit.receivers[k], options, lit.views[k]);
        k = (k + 1) % lit.receivers.size();
    }
    report_reads(state, reads_of(lit));
}

void draw(benchmark::State& state, model::Sampler sampler) {
    model::SamplerOptions options = options_of(sampler);
    Scene& lit = scene();
    options.samples = static_cast<int>(state.range(0));
    for (std::size_t k = 0; k < lit.receivers.size(); ++k)
        model::look(lit.slabs[0], lit.receivers[k], options, lit.views[k]);
    forget_reads(lit);
    std::vector<model::LightSample> samples;
    std::size_t k = 0;
    for (auto _ : state) {
        const glm::vec2 shift = model::shift_of(model::Shift::Random, {k, 0}, 0, 1);
        model::draw(lit.slabs, {&lit.views[k], 1}, options, shift, samples);
        benchmark::DoNotOptimize(samples.data());
        k = (k + 1) % lit.receivers.size();
    }
    report_reads(state, reads_of(lit));
    state.counters["a_sample"] =
        benchmark::Counter(static_cast<double>(state.iterations()) * options.samples,
                           benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void sizes(benchmark::internal::Benchmark* registered) {
    registered->ArgName("K")->Arg(63)->Arg(1000)->Unit(benchmark::kMicrosecond);
}

BENCHMARK_CAPTURE(look, uniform, model::Sampler::Uniform)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(look, precomputed, model::Sampler::Precomputed)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(look, pdis, model::Sampler::Pdis)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(look, systematic, model::Sampler::Systematic)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(look, cells, model::Sampler::Cells)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(draw, uniform, model::Sampler::Uniform)->Apply(sizes);
BENCHMARK_CAPTURE(draw, precomputed, model::Sampler::Precomputed)->Apply(sizes);
BENCHMARK_CAPTURE(draw, pdis, model::Sampler::Pdis)->Apply(sizes);
BENCHMARK_CAPTURE(draw, systematic, model::Sampler::Systematic)->Apply(sizes);
BENCHMARK_CAPTURE(draw, cells, model::Sampler::Cells)->Apply(sizes);

// Writes a float and a half of tables for each float of C_m, and more of mips.
void tables(benchmark::State& state) {
    const auto threads = static_cast<std::size_t>(state.range(0));
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const Slab slab = sample_data::make_reference_lamp().slabs[0];
    for (auto _ : state)
        benchmark::DoNotOptimize(model::build_tables(slab));
    state.counters["texels"] = benchmark::Counter(
        static_cast<double>(slab.coeffs.size()) * static_cast<double>(state.iterations()),
        benchmark::Counter::kIsRate);
}
BENCHMARK(tables)->ArgName("threads")->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);

shared::Brdf make_brdf(std::uint32_t kind) {
    shared::Brdf brdf{};
    brdf.kind = kind;
    brdf.diffuse = glm::vec3(0.4F);
    brdf.specular = glm::vec3(0.3F);
    brdf.exponent = 40.0F;
    brdf.alpha = {0.2F, 0.3F};
    brdf.cosines = {-0.9F, -0.9F, 0.95F};
    return brdf;
}

// Directions of a spiral over the hemisphere.
std::vector<glm::vec3> directions() {
    constexpr int kCount = 1024;
    std::vector<glm::vec3> spiral;
    for (int k = 0; k < kCount; ++k) {
        const float z = (static_cast<float>(k) + 0.5F) / kCount;
        const float azimuth = 2.0F * std::numbers::pi_v<float> * 0.618034F * static_cast<float>(k);
        const float radius = std::sqrt(1.0F - z * z);
        spiral.emplace_back(radius * std::cos(azimuth), radius * std::sin(azimuth), z);
    }
    return spiral;
}

void brdf_eval(benchmark::State& state, std::uint32_t kind) {
    const shared::Brdf brdf = make_brdf(kind);
    const std::vector<glm::vec3> to_light = directions();
    const glm::vec3 to_viewer = glm::normalize(glm::vec3(0.5F, 0.2F, 0.8F));
    std::size_t k = 0;
    for (auto _ : state)
        benchmark::DoNotOptimize(
            shared::brdf_eval(brdf, to_light[k++ % to_light.size()], to_viewer));
}

// And its density.
void brdf_sample(benchmark::State& state, std::uint32_t kind) {
    const shared::Brdf brdf = make_brdf(kind);
    const std::vector<glm::vec3> xi = directions();
    const glm::vec3 to_viewer = glm::normalize(glm::vec3(0.5F, 0.2F, 0.8F));
    std::size_t k = 0;
    for (auto _ : state) {
        const glm::vec3 to_light =
            shared::brdf_sample(brdf, to_viewer, glm::abs(xi[k++ % xi.size()]));
        benchmark::DoNotOptimize(shared::brdf_density(brdf, to_light, to_viewer));
    }
}

BENCHMARK_CAPTURE(brdf_eval, phong, shared::kBrdfPhong);
BENCHMARK_CAPTURE(brdf_eval, ggx, shared::kBrdfGgx);
BENCHMARK_CAPTURE(brdf_eval, ward, shared::kBrdfWard);
BENCHMARK_CAPTURE(brdf_eval, lafortune, shared::kBrdfLafortune);
BENCHMARK_CAPTURE(brdf_eval, halfway_disk, shared::kBrdfHalfwayDisk);
BENCHMARK_CAPTURE(brdf_sample, phong, shared::kBrdfPhong);
BENCHMARK_CAPTURE(brdf_sample, ggx, shared::kBrdfGgx);
BENCHMARK_CAPTURE(brdf_sample, ward, shared::kBrdfWard);
BENCHMARK_CAPTURE(brdf_sample, lafortune, shared::kBrdfLafortune);
BENCHMARK_CAPTURE(brdf_sample, halfway_disk, shared::kBrdfHalfwayDisk);

}  // namespace
}  // namespace nearfield::bench

BENCHMARK_MAIN();
