// SPDX-License-Identifier: Apache-2.0
#include "app/lab_devices.h"

#include "app/lab_camera.h"
#include "formats/files/error.h"
#include "sample_data/devices/virtual_lab.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>

namespace nearfield::app {
namespace {

devices::Mounting mounting_of(const sample_data::Bench& bench) {
    devices::Mounting mounting;
    mounting.first_position_mm = glm::dvec2(-150);
    if (bench.filter.pitch_m.x > 0 && bench.filter.pitch_m.y > 0)
        mounting.pitch_mm = 1000.0 * bench.filter.pitch_m;
    mounting.warm_up_rel = bench.lamp.warm_up_rel;
    mounting.warm_up_s = bench.lamp.warm_up_s;
    return mounting;
}

// The child's alone: this process answers for the devices and must not see them.
std::vector<std::string> environment_with_preload() {
    constexpr const char* kPreload = "LD_PRELOAD=";
    std::string preload = std::string(kPreload) + "libumockdev-preload.so.0";
    std::vector<std::string> variables;
    for (char** variable = environ; *variable != nullptr; ++variable) {
        const std::string text = *variable;
        if (text.starts_with(kPreload))
            preload += ":" + text.substr(std::strlen(kPreload));
        else
            variables.push_back(text);
    }
    variables.push_back(preload);
    return variables;
}

std::vector<char*> pointers_to(std::vector<std::string>& texts) {
    std::vector<char*> pointers;
    pointers.reserve(texts.size() + 1);
    for (std::string& text : texts)
        pointers.push_back(text.data());
    pointers.push_back(nullptr);
    return pointers;
}

pid_t start(std::vector<std::string> command) {
    if (command.front() == "nearfield")
        command.front() = std::filesystem::read_symlink("/proc/self/exe").string();
    std::vector<std::string> variables = environment_with_preload();
    pid_t child = 0;
    const int failure = posix_spawnp(&child, command.front().c_str(), nullptr, nullptr,
                                     pointers_to(command).data(), pointers_to(variables).data());
    if (failure != 0)
        throw Error{"cannot run command", command.front(), "a program",
                    std::generic_category().message(failure)};
    return child;
}

}  // namespace

int run_among_devices(const sample_data::Prepared& prepared,
                      bool fast,
                      const std::vector<std::string>& command) {
    const devices::VirtualLab lab(lab_of(prepared), mounting_of(sample_data::bench_of(*prepared)),
                                  fast);
    const pid_t child = start(command);
    // The terminal's Ctrl-C is the command's: it ends in its own way, then this does.
    std::signal(SIGINT, SIG_IGN);
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR)
        continue;
    constexpr int kKilled = 128;
    return WIFEXITED(status) ? WEXITSTATUS(status) : kKilled + WTERMSIG(status);
}

}  // namespace nearfield::app
