// SPDX-License-Identifier: Apache-2.0
// Two thousand things that people do, in no order: memory stays flat, nothing breaks.
#include "app/viewer/viewer.h"
#include "tests/render/scenes.h"

#include <gtest/gtest.h>
#include <malloc.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <random>
#include <thread>

namespace nearfield::viewer {
namespace {

constexpr const char* kScene = "soak.gltf";
constexpr int kSteps = 2000, kWarm = 800;

double resident_mib() {
    std::ifstream statm("/proc/self/statm");
    double total = 0, resident = 0;
    statm >> total >> resident;
    return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1024.0 * 1024.0);
}

bool has_sanitizer() {
#if defined(__SANITIZE_ADDRESS__)
    return true;
#else
    return false;
#endif
}

struct Soak {
    std::mt19937 random{7};
    Viewer viewer;
    glm::ivec2 size_px{160, 90};
    std::optional<Request> asked;
    Worker worker{[] {}};

    double any(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    }
    int pick(int count) { return static_cast<int>(any(0.0, count)); }

    int lamp() {
        const std::vector<EditedLamp>& lamps = viewer.history.now.lamps;
        return lamps.empty()
                   ? 0
                   : lamps[static_cast<std::size_t>(pick(static_cast<int>(lamps.size())))].id;
    }
    void load() {
        if (!std::filesystem::exists(kScene))
            write_scene(test::with_second_lamp(test::uneven_scene()), kScene);
        take(viewer, open_document(kScene));
    }
    void edit_something() {
        const int id = lamp();
        const EditedLamp* edited = find_lamp(viewer.history.now, id);
        glm::dmat4 pose =
            edited == nullptr ? glm::dmat4(1.0) : edited->luminaire.world_from_luminaire;
        pose[3] += glm::dvec4(any(-0.1, 0.1), any(-0.1, 0.1), any(-0.05, 0.05), 0.0);
        const bool has_many = viewer.history.now.lamps.size() > 3;
        switch (pick(8)) {
            case 0:
                return change(viewer, SetDim{id, any(0.0, 2.0)});
            case 1:
                return change(viewer,
                              SetTint{id, glm::vec3(glm::dvec3(any(0, 1), any(0, 1), 1.0))});
            case 2:
                return change(viewer, SetOn{id, any(0, 1) < 0.7});
            case 3:
                return change(viewer, Aim{id, {any(-1, 1), any(-1, 1), 0.0}});
            case 4:
                return has_many ? change(viewer, Remove{id})
                                : change(viewer, Duplicate{id, {any(-0.3, 0.3), 0.0, 0.0}});
            default:
                return change(viewer, SetPose{id, pose}, pick(3));
        }
    }
    void do_something() {
        const int what = pick(100);
        if (what < 60)
            edit_something();
        else if (what < 70)
            pick(2) == 0 ? undo(viewer) : redo(viewer);
        else if (what < 82)
            viewer.view = orbited(viewer.view, any(-0.2, 0.2), any(-0.1, 0.1));
        else if (what < 87)
            size_px = {96 + 16 * pick(8), 64 + 16 * pick(4)};
        else if (what < 91)
            viewer.dial = pick(4);
        else if (what < 95)
            viewer.look.shown = static_cast<Shown>(pick(3)), viewer.is_stale = true;
        else if (what < 97)
            load();
        else
            keep_state(viewer);
    }
    void ask() {
        Request request = request_of(viewer, size_px);
        if (asked && is_lit_alike(*asked, request))
            return;
        request.serial = ++viewer.serial;
        asked = request;
        worker.show(std::move(request));
    }
    bool is_answered() {
        refresh(viewer, worker.progress());
        EXPECT_EQ(viewer.progress.error, "");
        return viewer.frame && viewer.frame->serial >= viewer.serial;
    }
    void wait_for_picture() {
        while (!is_answered() || !viewer.progress.is_final)
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    /// Resident memory in always the same state: what is kept of pictures depends on what was done.
    double settled_mib() {
        load();
        viewer.dial = 0;
        for (const glm::ivec2 size : {glm::ivec2(208, 112), glm::ivec2(160, 90)}) {
            size_px = size;
            ask();
            wait_for_picture();
        }
        malloc_trim(0);  // what is free is no leak
        return resident_mib();
    }
};

TEST(ViewerSoak, MemoryStaysFlat) {
    Soak soak;
    soak.load();
    double warm_mib = 0.0;
    for (int k = 0; k < kSteps && !testing::Test::HasFailure(); ++k) {
        soak.do_something();
        soak.ask();
        // Every tenth time the draft is waited for, every hundredth the whole picture.
        while (k % 10 == 0 && !soak.is_answered())
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
        if (k % 100 == 0)
            soak.wait_for_picture();
        if (k == kWarm)
            warm_mib = soak.settled_mib();
    }
    const double end_mib = soak.settled_mib();
    RecordProperty("warm_mib", std::to_string(warm_mib));
    RecordProperty("end_mib", std::to_string(end_mib));
    std::printf("%d steps: %.1f MiB after %d, %.1f MiB at the end\n", kSteps, warm_mib, kWarm,
                end_mib);
    if (!has_sanitizer()) {
        EXPECT_LT(end_mib, 1.05 * warm_mib);
    }
}

}  // namespace
}  // namespace nearfield::viewer
