// SPDX-License-Identifier: Apache-2.0
// Measures, for a large lamp (11 x 9 images of 256 x 256 texels, RGB), from a warm cache:
//
//   layout_bench ready    how long until a packed file is ready to render, against the time of
//                         reading its C_m alone, and whether tables are better read or built
//   layout_bench          that, and how the images are best laid out in an EXR file: size, time
//                         to write and to read into [channel][m][j][i]
//
// The tables in docs/formats.md are this program's output. Not run by ctest: it needs a quiet
// machine and 400 MB of disk.
#include "formats/files/exr_file.h"
#include "formats/files/lightfield.h"
#include "formats/files/lightfield_parts.h"
#include "formats/files/luminaire.h"
#include "formats/model/prepared.h"
#include "formats/model/tables.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>

namespace nearfield {
namespace {

constexpr int kRepeats = 9;
constexpr const char* kFile = "layout_bench.exr";

/// A made-up headlight: a bright spot below a cut-off line, different in every image, dark
/// elsewhere, with the fine grain that measured coefficients have (grain is what ZIP cannot
/// remove).
LightField bench_lamp() {
    Slab slab;
    slab.delta_m = 3;
    slab.grid = {11, 9};
    slab.pitch_m = {0.0165, 0.0165};
    slab.texels = {256, 256};
    slab.s_min_m = {-1.6, -1.6};
    slab.s_max_m = {1.6, 1.6};
    slab.profile = {"bspline", {{1.125, 1.5, 0.5}, {0.75, 0.0, -1.0}, {1.125, -1.5, 0.5}}};
    slab.channels = 3;
    slab.coeffs.resize(slab.image_offset(3, 0));
    std::uint32_t random = 1;
    for (std::size_t k = 0; k < slab.coeffs.size(); ++k) {
        const std::size_t image = k / slab.texel_count() % 99, texel = k % slab.texel_count();
        const std::size_t column = texel % 256, row = texel / 256;
        const double x = static_cast<double>(column) / 128 - 1;
        const double y = static_cast<double>(row) / 128 - 1;
        random = random * 1664525U + 1013904223U;
        const double grain = 1 + 0.01 * random / 4294967296.0;
        const bool is_lit = y < 0.05 * static_cast<double>(image % 11) - 0.2;
        const double spot = std::exp(-8 * x * x - 20 * (y + 0.3) * (y + 0.3));
        slab.coeffs[k] = is_lit ? static_cast<float>(1e5 * spot * grain) : 0.0F;
    }
    LightField lamp;
    lamp.slabs.push_back(std::move(slab));
    return lamp;
}

/// The ways to cut the same array into parts.
template <typename Value>
std::vector<exr::Atlas<Value>> parts_of(const std::string& layout, const Slab& slab, Value* data) {
    if (layout == "one part, tile = image")
        return {image_atlas("coeffs", slab, slab.texels, data)};
    std::vector<exr::Atlas<Value>> parts;
    for (int m = 0; m < slab.image_count(); ++m) {
        exr::Atlas<Value> part{fmt::format("image{:02}", m), {1, 1}, slab.texels, {},
                               exr::Values::NonNegative,     false};
        for (int channel = 0; channel < 3; ++channel) {
            part.planes.push_back(exr::upright(std::string(1, "RGB"[channel]), data, slab.texels));
            part.planes.back().first += static_cast<std::ptrdiff_t>(slab.image_offset(channel, m));
        }
        parts.push_back(std::move(part));
    }
    if (layout == "a part per image")
        return parts;
    exr::Atlas<Value> all{"coeffs", {1, 1}, slab.texels, {}, exr::Values::NonNegative, false};
    for (const exr::Atlas<Value>& part : parts)
        for (exr::Plane<Value> plane : part.planes) {
            plane.channel = part.part + "." + plane.channel;
            all.planes.push_back(std::move(plane));
        }
    return {all};
}

struct Cost {
    double wall_ms = std::numeric_limits<double>::max();
    double cpu_ms =
        std::numeric_limits<double>::max();  // of all threads: what other programs disturb least
};

Cost best_of(const std::function<void()>& run) {
    Cost best;
    for (int k = 0; k < kRepeats; ++k) {
        const double start_s = now_s();
        const std::clock_t start = std::clock();
        run();
        best.cpu_ms =
            std::min(best.cpu_ms, 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
        best.wall_ms = std::min(best.wall_ms, 1e3 * (now_s() - start_s));
    }
    return best;
}

void print_row(const std::string& name, const Cost& write, const Cost& read) {
    const double mib = static_cast<double>(std::filesystem::file_size(kFile)) / 1048576.0;
    fmt::print("| {} | {:.1f} | {:.0f} ({:.0f}) | {:.0f} ({:.0f}) |\n", name, mib, write.wall_ms,
               write.cpu_ms, read.wall_ms, read.cpu_ms);
}

void bench_layouts(const Slab& slab) {
    for (const auto compression : {exr::Compression::None, exr::Compression::Zip}) {
        const std::string suffix = compression == exr::Compression::Zip ? ", ZIP" : "";
        for (const std::string layout :
             {"one part, tile = image", "a part per image", "one part, 297 channels"}) {
            const Cost write = best_of([&] {
                exr::write(parts_of(layout, slab, slab.coeffs.data()), compression, {}, kFile);
            });
            std::vector<float> coeffs;
            const Cost read = best_of([&] {
                exr::Reader reader(kFile);
                coeffs = std::vector<float>(slab.coeffs.size());
                const auto parts = parts_of(layout, slab, coeffs.data());
                for (const auto& part : parts)
                    reader.require(part);
                for (const auto& part : parts)
                    reader.read(part);
            });
            if (coeffs != slab.coeffs)
                fmt::print("{}: read other values than were written\n", layout);
            print_row(layout + suffix, write, read);
        }
    }
}

/// A file's bytes from `offset` on, into new memory and unchecked, by `threads` threads: what a
/// reader of C_m cannot beat.
void read_bytes(const char* file, std::size_t offset, std::size_t size, std::size_t threads) {
    const int descriptor = open(file, O_RDONLY | O_CLOEXEC);
    const std::unique_ptr<char[]> bytes(new char[size]);
    tbb::parallel_for(std::size_t{0}, threads, [&](std::size_t k) {
        const std::size_t end = (k + 1) * size / threads;
        for (std::size_t at = k * size / threads; at < end;) {
            const ssize_t got =
                pread(descriptor, &bytes[at], end - at, static_cast<off_t>(offset + at));
            if (got <= 0)
                break;
            at += static_cast<std::size_t>(got);
        }
    });
    close(descriptor);
}

void print_ready(const std::string& name, const Cost& cost, const Cost& unit) {
    fmt::print("| {} | {:.1f} ({:.1f}) | {:.2f} ({:.2f}) |\n", name, cost.wall_ms, cost.cpu_ms,
               cost.wall_ms / unit.wall_ms, cost.cpu_ms / unit.cpu_ms);
}

std::vector<model::PreparedSlab> ready_to_render(const char* file) {
    std::vector<model::PreparedSlab> prepared;
    LightField lamp = read_lightfield(file);
    for (Slab& slab : lamp.slabs)
        prepared.push_back(model::prepare(std::move(slab)));
    return prepared;
}

void bench_ready(const LightField& lamp, std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    constexpr const char* kLean = "layout_bench_lean.exr";
    write_luminaire({lamp, {}}, std::nullopt, kLean);
    write_luminaire(model::pack(lamp, false), std::nullopt, kFile);
    const std::size_t size = lamp.slabs[0].coeffs.size() * sizeof(float);
    const Cost alone = best_of([&] { read_bytes(kLean, 4096, size, threads); });
    fmt::print("\n| {} thread(s) | ms (CPU) | ratio |\n| --- | --- | --- |\n", threads);
    print_ready("C_m alone into memory, unchecked", alone, alone);
    const auto row = [&](const char* name, const std::function<void()>& run) {
        const Cost cost = best_of(run);
        print_ready(name, cost, alone);
        return cost;
    };
    row("`read_lightfield`, lean", [&] { read_lightfield(kLean); });
    row("`read_lightfield`, with tables", [&] { read_lightfield(kFile); });
    row("**ready to render, lean**", [&] { ready_to_render(kLean); });
    row("**ready to render, with tables**", [&] { ready_to_render(kFile); });
    const auto build = [&](const LightField& lightfield) {
        for (const Slab& slab : lightfield.slabs)
            model::build_tables(slab);
    };
    row("`build_tables`", [&] { build(lamp); });
    row("tables built: `read_lightfield` and `build_tables`",
        [&] { build(read_lightfield(kLean)); });
    row("tables read: `read_luminaire`", [&] { read_luminaire(kFile); });
    std::remove(kLean);
    std::remove(kFile);
}

void run(bool only_ready) {
    const LightField lamp = bench_lamp();
    for (const std::size_t threads : {std::size_t{1}, std::size_t{2}})
        bench_ready(lamp, threads);
    if (only_ready)
        return;
    fmt::print(
        "\n| layout | MiB | write, ms (CPU) | read, ms (CPU) |\n| --- | --- | --- | --- |\n");
    bench_layouts(lamp.slabs[0]);
    const Cost write = best_of([&] { write_luminaire({lamp, {}}, std::nullopt, kFile); });
    print_row("`read_lightfield` of a lean luminaire, metadata included", write,
              best_of([&] { read_lightfield(kFile); }));
    const std::size_t size = std::filesystem::file_size(kFile);
    print_row("the file's bytes alone into memory, unchecked", write,
              best_of([&] { read_bytes(kFile, 0, size, 2); }));
    std::remove(kFile);
}

}  // namespace
}  // namespace nearfield

int main(int argc, char** argv) {
    nearfield::run(argc > 1 && std::string(argv[1]) == "ready");
    return 0;
}
