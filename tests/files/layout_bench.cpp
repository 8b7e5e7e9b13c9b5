// SPDX-License-Identifier: Apache-2.0
// Measures how the images C_m of a large lamp (11 x 9 images of 256 x 256 texels, RGB) are best
// laid out in an EXR file: size, time to write and time to read into [channel][m][j][i], best of
// five from a warm cache. The table in docs/formats.md is this program's output. Not run by ctest:
// it needs a quiet machine and 400 MB of disk.
#include "formats/files/exr_file.h"
#include "formats/files/lightfield.h"
#include "formats/files/lightfield_parts.h"
#include "formats/files/luminaire.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>

namespace {

using namespace nearfield;

constexpr int kRepeats = 5;
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
        const double x = static_cast<double>(texel % 256) / 128 - 1;
        const double y = static_cast<double>(texel / 256) / 128 - 1;
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

}  // namespace

int main() {
    const LightField lamp = bench_lamp();
    fmt::print("| layout | MiB | write, ms (CPU) | read, ms (CPU) |\n| --- | --- | --- | --- |\n");
    bench_layouts(lamp.slabs[0]);
    const Cost write = best_of([&] { write_luminaire({lamp, {}}, std::nullopt, kFile); });
    const Cost read = best_of([&] { read_lightfield(kFile); });
    print_row("read_lightfield, lean", write, read);
    std::vector<char> bytes(std::filesystem::file_size(kFile));
    const Cost raw = best_of([&] {
        bytes = std::vector<char>(bytes.size());
        std::ifstream(kFile, std::ios::binary).read(bytes.data(), static_cast<long>(bytes.size()));
    });
    print_row("the file's bytes alone, one thread", write, raw);
    std::remove(kFile);
    return 0;
}
