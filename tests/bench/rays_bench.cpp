// SPDX-License-Identifier: Apache-2.0
// How fast TM-25 files are written and read, and how far that is from the disk:
//   rays_bench [RAYS]
// Writes the reference lamp's rays to the working directory, reads them, and moves the same bytes
// bare; removes the files.
#include "formats/files/provenance.h"
#include "formats/rays/export_rays.h"
#include "formats/rays/ray_file.h"
#include "sample_data/reference_lamp.h"

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <functional>
#include <vector>

namespace nearfield {
namespace {

constexpr const char* kFile = "rays_bench.tm25ray";
constexpr const char* kBareFile = "rays_bench.bare";
constexpr std::size_t kBlock = 65536 * 28;  // as the writer writes

// Processor time of all threads beside the clock's: what a busy machine does not change.
void measure(const char* what, std::uint64_t rays, const std::function<void()>& work) {
    const double start_s = now_s();
    const std::clock_t start = std::clock();
    work();
    const double time_s = now_s() - start_s;
    const double cpu_s = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    const double million = 1e-6 * static_cast<double>(rays);
    const double mb = 1e-6 * static_cast<double>(std::filesystem::file_size(kFile));
    fmt::print(
        "{:<26} {:6.2f} s {:6.1f} M rays/s {:6.0f} MB/s; {:6.2f} s of processor, {:6.1f} M rays/s "
        "of it; peak memory so far {:.0f} MiB\n",
        what, time_s, million / time_s, mb / time_s, cpu_s, million / cpu_s,
        finish_run(start_s, 1).peak_memory_mib);
}

void read_bare(const char* name) {
    std::ifstream file(name, std::ios::binary);
    std::vector<char> block(kBlock);
    while (file.read(block.data(), static_cast<std::streamsize>(block.size())))
        continue;
}

void write_bare() {
    std::ofstream file(kBareFile, std::ios::binary);
    const std::vector<char> block(kBlock, 'x');
    for (std::uintmax_t left = std::filesystem::file_size(kFile); left > 0;) {
        const auto bytes = std::min<std::uintmax_t>(left, block.size());
        file.write(block.data(), static_cast<std::streamsize>(bytes));
        left -= bytes;
    }
}

void run(std::uint64_t rays) {
    const LightField lamp = sample_data::make_reference_lamp();
    rays::ExportOptions options;
    options.rays = rays;
    std::filesystem::remove(kFile);
    double flux = 0;
    measure("draw and write", rays, [&] { rays::export_rays(lamp, kFile, options); });
    measure("write the bytes alone", rays, write_bare);
    measure("read the bytes alone", rays, [] { read_bare(kFile); });
    for (int k = 0; k < 3; ++k)
        measure("read rays, chunk by chunk", rays, [&flux] {
            rays::RayFile file(kFile, false);
            for (rays::RayChunk chunk; file.next(chunk);)
                flux += chunk.flux;
        });
    measure("read rays into memory", rays,
            [&flux] { flux += rays::read_rays(kFile).flux_of_rays; });
    fmt::print("{:.6g} lm\n", flux / 4);
    std::filesystem::remove(kFile);
    std::filesystem::remove(kBareFile);
}

}  // namespace
}  // namespace nearfield

int main(int count, char** arguments) {
    constexpr std::uint64_t kRays = 10'000'000;
    nearfield::run(count > 1 ? std::strtoull(arguments[1], nullptr, 10) : kRays);
}
