// SPDX-License-Identifier: Apache-2.0
/// Structs to JSON and back by one list of their fields:
///
///     template <typename Visit> void visit_fields(Visit& visit, Lens& lens) {
///         visit("fx_px", lens.fx_px);
///     }
///
/// found by argument-dependent lookup; so is `words_of(Enum)`, a list of (value, word), for enums.
/// Numbers must be finite; unknown keys are refused; a std::optional without value has no key;
/// missing ones keep their values unless the reader is told that all are required.
#pragma once

#include "formats/files/error.h"
#include "formats/files/json_field.h"
#include "formats/files/lightfield.h"

#include <glm/glm.hpp>

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

namespace nearfield {

template <typename Visit>
void visit_fields(Visit& visit, Rigid& pose) {
    visit("rotation", pose.rotation);
    visit("translation_m", pose.translation_m);
}

template <typename Visit>
void visit_fields(Visit& visit, Profile& profile) {
    visit("name", profile.name);
    visit("cells", profile.cells);
}

/// Builds `json` from the fields that it visits.
class FieldWriter {
  public:
    Json json = Json::object();

    template <typename T>
    void operator()(const char* key, T& member) {
        json[key] = value(member);
    }
    template <typename T>
    void operator()(const char* key, std::optional<T>& member) {
        if (member)
            json[key] = value(*member);
    }

  private:
    template <typename T>
    static Json value(T& member) {
        if constexpr (std::is_enum_v<T>) {
            for (const auto& [known, word] : words_of(member))
                if (known == member)
                    return word;
            return nullptr;
        } else if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, std::string>) {
            return member;
        } else {
            FieldWriter writer;
            visit_fields(writer, member);
            return std::move(writer.json);
        }
    }
    template <int N, typename T>
    static Json value(glm::vec<N, T>& vector) {
        Json list = Json::array();
        for (int k = 0; k < N; ++k)
            list.push_back(vector[k]);
        return list;
    }
    static Json value(glm::dmat3& m) {  // row by row
        Json list = Json::array();
        for (int k = 0; k < 9; ++k)
            list.push_back(m[k % 3][k / 3]);
        return list;
    }
    template <std::size_t kCount>
    static Json value(std::array<double, kCount>& numbers) {
        return numbers;
    }
    template <typename T>
    static Json value(std::vector<T>& elements) {
        Json list = Json::array();
        for (T& element : elements)
            list.push_back(value(element));
        return list;
    }
};

enum class Missing { Kept, Refused };

/// Fills the fields that it visits.
class FieldReader {
  public:
    FieldReader(JsonField field, Missing missing) : field_(std::move(field)), missing_(missing) {}

    template <typename T>
    void operator()(const char* key, T& member) {
        known_.emplace_back(key);
        if (missing_ == Missing::Refused || field_.has(key))
            read(field_.at(key), member);
    }
    template <typename T>
    void operator()(const char* key, std::optional<T>& member) {
        known_.emplace_back(key);
        member.reset();
        if (field_.has(key))
            read(field_.at(key), member.emplace());
    }

    /// Throws Error at the first key that nobody asked for.
    void refuse_others() const { field_.only(known_); }

  private:
    template <typename T>
    void read(const JsonField& field, T& member) const {
        if constexpr (std::is_enum_v<T>) {
            read_word(field, member);
        } else {
            FieldReader reader(field, missing_);
            visit_fields(reader, member);
            reader.refuse_others();
        }
    }
    void read(const JsonField& field, double& member) const { member = field.number(); }
    void read(const JsonField& field, bool& member) const { member = field.boolean(); }
    void read(const JsonField& field, std::string& member) const { member = field.text(); }
    void read(const JsonField& field, int& member) const {
        member = field.integer(std::numeric_limits<int>::min(), std::numeric_limits<int>::max());
    }
    template <int N, typename T>
    void read(const JsonField& field, glm::vec<N, T>& vector) const {
        const std::vector<JsonField> elements = field.elements(static_cast<std::size_t>(N));
        for (int k = 0; k < N; ++k)
            read(elements[static_cast<std::size_t>(k)], vector[k]);
    }
    void read(const JsonField& field, glm::dmat3& m) const {
        const std::vector<double> values = field.numbers(9);
        for (int k = 0; k < 9; ++k)
            m[k % 3][k / 3] = values[static_cast<std::size_t>(k)];
    }
    template <std::size_t kCount>
    void read(const JsonField& field, std::array<double, kCount>& numbers) const {
        const std::vector<double> values = field.numbers(kCount);
        std::copy(values.begin(), values.end(), numbers.begin());
    }
    template <typename T>
    void read(const JsonField& field, std::vector<T>& elements) const {
        elements.clear();
        for (const JsonField& element : field.elements())
            read(element, elements.emplace_back());
    }
    template <typename Enum>
    static void read_word(const JsonField& field, Enum& member) {
        const std::string text = field.text();
        std::string expected;
        for (const auto& [value, word] : words_of(member)) {
            if (text == word) {
                member = value;
                return;
            }
            expected += (expected.empty() ? "" : ", ") + std::string(word);
        }
        throw Error{"bad value", field.where(), "one of " + expected, "'" + text + "'"};
    }

    JsonField field_;
    Missing missing_;
    std::vector<std::string> known_;
};

}  // namespace nearfield
