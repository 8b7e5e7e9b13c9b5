// SPDX-License-Identifier: Apache-2.0
#include "formats/files/json_field.h"

#include "formats/files/error.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace nearfield {

void JsonField::fail(const std::string& expected) const {
    constexpr std::size_t kShown = 60;  // enough to recognize, short enough for one line
    std::string got = json_text(*value_);
    if (got.size() > kShown)
        got = got.substr(0, kShown) + "...";
    throw Error{"bad metadata", where_, expected, got};
}

bool JsonField::has(const std::string& key) const {
    return value_->is_object() && value_->contains(key);
}

void JsonField::only(const std::vector<std::string>& known) const {
    if (!value_->is_object())
        fail("an object");
    for (const auto& [key, value] : value_->items())
        if (std::find(known.begin(), known.end(), key) == known.end())
            throw Error{"unknown key", where_, fmt::format("one of {}", fmt::join(known, ", ")),
                        "'" + key + "'"};
}

std::vector<std::string> JsonField::keys() const {
    if (!value_->is_object())
        fail("an object");
    std::vector<std::string> keys;
    for (const auto& [key, value] : value_->items())
        keys.push_back(key);
    return keys;
}

JsonField JsonField::at(const std::string& key) const {
    if (!value_->is_object())
        fail("an object");
    const auto found = value_->find(key);
    if (found == value_->end())
        throw Error{"missing metadata", where_, "key '" + key + "'"};
    return {*found, where_ + "." + key};
}

bool JsonField::is_list() const {
    return value_->is_array();
}

std::vector<JsonField> JsonField::elements() const {
    if (!value_->is_array())
        fail("a list");
    std::vector<JsonField> fields;
    fields.reserve(value_->size());
    for (std::size_t k = 0; k < value_->size(); ++k)
        fields.emplace_back((*value_)[k], fmt::format("{}[{}]", where_, k));
    return fields;
}

std::vector<JsonField> JsonField::elements(std::size_t count) const {
    if (!value_->is_array() || value_->size() != count)
        fail(fmt::format("a list of {}", count));
    return elements();
}

double JsonField::number() const {
    if (!value_->is_number() || !std::isfinite(value_->get<double>()))
        fail("a finite number");
    return value_->get<double>();
}

int JsonField::integer(int least, int most) const {
    const double value = value_->is_number_integer() ? value_->get<double>() : NAN;
    if (!(value >= least && value <= most))
        fail(fmt::format("an integer from {} to {}", least, most));
    return static_cast<int>(value);
}

bool JsonField::boolean() const {
    if (!value_->is_boolean())
        fail("true or false");
    return value_->get<bool>();
}

std::string JsonField::text() const {
    if (!value_->is_string())
        fail("a text");
    return value_->get<std::string>();
}

std::vector<double> JsonField::numbers(std::size_t count) const {
    std::vector<double> values;
    for (const JsonField& field : elements(count))
        values.push_back(field.number());
    return values;
}

Json parse_json(const std::string& text, const std::string& where) {
    try {
        return Json::parse(text);
    } catch (const Json::exception& error) {
        throw Error{"bad JSON", where, "", error.what()};
    }
}

std::string json_text(const Json& document) {
    return document.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace nearfield
