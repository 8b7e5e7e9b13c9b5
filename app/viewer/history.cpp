// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/history.h"

#include <algorithm>
#include <utility>

namespace nearfield::viewer {
namespace {

constexpr std::size_t kMostSteps = 500;

bool step(History& history, std::vector<History::Step>& from, std::vector<History::Step>& to) {
    if (from.empty())
        return false;
    History::Step next = std::move(from.back());
    from.pop_back();
    // Ids of what was undone must not be given again: lights are known by them.
    const int next_id = history.now.next_id;
    to.push_back({std::move(history.now), next.name});
    history.now = std::move(next.document);
    history.now.next_id = std::max(history.now.next_id, next_id);
    history.gesture = 0;
    return true;
}

}  // namespace

void edit(History& history, const Edit& edit, int gesture) {
    Document next = edited(history.now, edit);
    if (gesture == 0 || gesture != history.gesture) {
        history.past.push_back({std::move(history.now), name_of(edit)});
        if (history.past.size() > kMostSteps)
            history.past.erase(history.past.begin());
    }
    history.now = std::move(next);
    history.future.clear();
    history.gesture = gesture;
}

bool undo(History& history) {
    return step(history, history.past, history.future);
}

bool redo(History& history) {
    return step(history, history.future, history.past);
}

}  // namespace nearfield::viewer
