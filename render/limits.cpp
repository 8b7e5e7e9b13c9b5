// SPDX-License-Identifier: Apache-2.0
#include "render/limits.h"

#include <sys/resource.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>

namespace nearfield::render {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::infinity();

double machine_has_bytes() {
    std::ifstream file("/proc/meminfo");
    for (std::string name; file >> name;) {
        double kib = 0.0;
        if (name == "MemAvailable:" && file >> kib)
            return 1024.0 * kib;
    }
    return kUnknown;
}

/// The limit of address space less what is in use.
double process_may_bytes() {
    rlimit limit{};
    if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
        return kUnknown;
    double pages = 0.0;
    std::ifstream("/proc/self/statm") >> pages;
    constexpr double kPageBytes = 4096.0;
    return std::max(static_cast<double>(limit.rlim_cur) - kPageBytes * pages, 0.0);
}

}  // namespace

double available_memory_bytes() {
    return std::min(machine_has_bytes(), process_may_bytes());
}

}  // namespace nearfield::render
