// SPDX-License-Identifier: Apache-2.0
/// Words that stand for values in JSON.
#pragma once

#include "formats/files/error.h"
#include "formats/files/json_field.h"

#include <array>
#include <string>
#include <string_view>
#include <utility>

namespace nearfield::capture {

template <typename Value, std::size_t kCount>
using Words = std::array<std::pair<std::string_view, Value>, kCount>;

template <typename Value, std::size_t kCount>
Value meaning_of(const Words<Value, kCount>& words, const JsonField& field) {
    const std::string text = field.text();
    std::string known;
    for (const auto& [word, value] : words) {
        if (word == text)
            return value;
        known += (known.empty() ? "" : ", ") + std::string(word);
    }
    throw Error{"bad value", field.where(), "one of " + known, "'" + text + "'"};
}

template <typename Value, std::size_t kCount>
std::string word_for(const Words<Value, kCount>& words, Value wanted) {
    for (const auto& [word, value] : words)
        if (value == wanted)
            return std::string(word);
    return "?";
}

}  // namespace nearfield::capture
