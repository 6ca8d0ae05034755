// Parts of messages as JSON, for describe() (protocol_examples.h).
#pragma once

#include <nlohmann/json.hpp>

#include "tests/unit/protocol_examples.h"

namespace brume::wire::json {

inline Json number(uint64_t value) { return Json(std::to_string(value)); }
inline Json text(const flatbuffers::String* value) { return value ? Json(value->c_str()) : Json(nullptr); }
inline Json vec(const Vec3* v) { return v ? Json{v->x(), v->y(), v->z()} : Json(nullptr); }
inline Json quat(const Quat* q) { return q ? Json{q->x(), q->y(), q->z(), q->w()} : Json(nullptr); }
template <class T>
Json maybe(flatbuffers::Optional<T> value) {
    return value ? Json(*value) : Json(nullptr);
}

inline Json names(const flatbuffers::Vector<flatbuffers::Offset<flatbuffers::String>>* list) {
    if (!list) return nullptr;
    Json out = Json::array();
    for (const auto* name : *list) out.push_back(name->c_str());
    return out;
}

inline Json frustum(const Frustum& f) {
    return {{"left", f.left()}, {"right", f.right()}, {"up", f.up()}, {"down", f.down()}};
}

inline Json floats(const flatbuffers::Vector<float>* list) {
    return list ? Json(std::vector<float>(list->begin(), list->end())) : Json(nullptr);
}

Json ofInput(const Input& m); // with its command

} // namespace brume::wire::json
