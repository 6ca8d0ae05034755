#include "common/ply/points.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace brume::ply {
namespace {

// Where a slot's numbers come from: the first of these names that the file has.
struct Source {
    Slot slot;
    std::string_view names[3];
};
constexpr Source kSources[]{{kX, {"x"}},
                            {kY, {"y"}},
                            {kZ, {"z"}},
                            {kScale, {"scale"}},
                            {kRadius, {"radius"}},
                            {kSigmaT, {"sigma_t"}},
                            {kOpacity, {"opacity"}},
                            {kRed, {"red", "diffuse_red", "r"}},
                            {kGreen, {"green", "diffuse_green", "g"}},
                            {kBlue, {"blue", "diffuse_blue", "b"}},
                            {kId, {"id"}},
                            {kVX, {"vx"}},
                            {kVY, {"vy"}},
                            {kVZ, {"vz"}},
                            {kAxisAX, {"axis_a_x"}},
                            {Slot(kAxisAX + 1), {"axis_a_y"}},
                            {Slot(kAxisAX + 2), {"axis_a_z"}},
                            {Slot(kAxisAX + 3), {"axis_b_x"}},
                            {Slot(kAxisAX + 4), {"axis_b_y"}},
                            {Slot(kAxisAX + 5), {"axis_b_z"}},
                            {Slot(kAxisAX + 6), {"axis_c_x"}},
                            {Slot(kAxisAX + 7), {"axis_c_y"}},
                            {kAxisCZ, {"axis_c_z"}}};

using Places = std::array<size_t, kSlots>; // of each slot's property; the element's count: none

class Finder {
public:
    Finder(Reader& in, const Element& vertex) : in_(in), vertex_(vertex) {}

    size_t none() const { return vertex_.properties.size(); }
    const Property& at(size_t property) const { return vertex_.properties[property]; }

    size_t find(const Source& source) const {
        for (const std::string_view name : source.names)
            if (const size_t p = in_.find(vertex_, name); p < none()) {
                if (at(p).list) in_.fail(fmt::format("vertex property {} is a list; expected one number", name));
                return p;
            }
        return none();
    }

private:
    Reader& in_;
    const Element& vertex_;
};

// Which property goes where. Of sizes, and of extinctions, the file's own ones are left out that are not needed.
Places placesOf(Reader& in, const Element& vertex, PointsWanted wanted, std::vector<std::string>& notes) {
    const Finder finder(in, vertex);
    const size_t none = finder.none();
    Places places;
    places.fill(none);
    for (const Source& source : kSources) {
        const bool velocity = source.slot >= kVX && source.slot <= kVZ;
        const bool unwanted = (source.slot == kId && !wanted.ids) || (velocity && !wanted.velocities) ||
                              (source.slot >= kAxisAX && !wanted.axes) ||
                              (wanted.corners && (source.slot == kScale || source.slot == kRadius)) ||
                              (source.slot == kRadius && places[kScale] < none) ||
                              (source.slot == kOpacity && (wanted.corners || places[kSigmaT] < none));
        if (!unwanted) places[source.slot] = finder.find(source);
    }
    if (const size_t id = places[kId]; id < none && isFloat(finder.at(id).type)) places[kId] = none;
    if (std::max({places[kX], places[kY], places[kZ]}) == none) in.fail("element vertex lacks one of x, y, z");
    if (std::max({places[kVX], places[kVY], places[kVZ]}) == none) places[kVX] = places[kVY] = places[kVZ] = none;
    const size_t colours[]{places[kRed], places[kGreen], places[kBlue]};
    if (const auto there = std::ranges::count_if(colours, [&](size_t p) { return p < none; }); there % 3 != 0) {
        notes.push_back("of red, green and blue some are missing: colours are not read");
        places[kRed] = places[kGreen] = places[kBlue] = none;
    }
    return places;
}

// The number that stands for 1 among numbers of a type, of which `most` is the largest.
double wholeOf(Type type, double most) {
    if (type == Type::u8 || type == Type::i8) return 255;
    if (isFloat(type) && most < 2) return 1;
    return most <= 255 ? 255 : most <= 65535 ? 65535 : type == Type::i32 ? 2147483647.0 : 4294967295.0;
}

// Brings numbers of one type to parts of 1. What is told: a range that does not go without saying.
void toParts(const char* name, Type type, const std::vector<Slot>& slots, Points& points) {
    // Bytes and words of a program that gives them a sign.
    const double turn = type == Type::i8 ? 256 : type == Type::i16 ? 65536 : 0;
    double most = 0;
    for (const Slot slot : slots)
        for (double& x : points.columns[slot]) {
            if (x < 0) x += turn;
            if (std::isfinite(x)) most = std::max(most, x);
        }
    const double whole = wholeOf(type, most);
    for (const Slot slot : slots) {
        points.whole[slot] = whole;
        for (double& x : points.columns[slot]) x = whole == 1 && x < 2 ? std::min(x, 1.0) : x / whole;
    }
    if (whole == 1 && most > 1)
        points.notes.push_back(fmt::format("{} reach {}: what is above 1 counts as 1", name, most));
    else if (type != Type::u8 && whole > 1)
        points.notes.push_back(fmt::format("{} reach {}: {:.0f} stands for 1", name, most, whole));
}

// The same for channels that may differ in type.
void toParts(const char* name, std::vector<Slot> slots, const Element& vertex, const Places& places, Points& points) {
    std::erase_if(slots, [&](Slot slot) { return !points.has(slot); });
    while (!slots.empty()) {
        const auto typeOf = [&](Slot slot) { return vertex.properties[places[slot]].type; };
        const Type type = typeOf(slots[0]);
        std::vector<Slot> alike;
        std::erase_if(slots, [&](Slot slot) {
            if (typeOf(slot) == type) alike.push_back(slot);
            return typeOf(slot) == type;
        });
        toParts(name, type, alike, points);
    }
}

} // namespace

Points readPoints(Reader& in, const Element& vertex, PointsWanted wanted) {
    Points out;
    const Places places = placesOf(in, vertex, wanted, out.notes);
    std::vector<Slot> slot_of(vertex.properties.size(), kSlots);
    for (size_t slot = 0; slot < kSlots; ++slot)
        if (places[slot] < slot_of.size()) slot_of[places[slot]] = Slot(slot);
    for (size_t p = 0; p < slot_of.size(); ++p)
        if (slot_of[p] == kSlots) out.ignored.push_back(vertex.properties[p].name);
    for (uint64_t row = 0; row < vertex.count; ++row) {
        in.beginRow(vertex, row);
        for (size_t p = 0; p < slot_of.size(); ++p) {
            const Property& property = vertex.properties[p];
            for (uint64_t n = property.list ? in.length(property) : 1; n > 0; --n) {
                const double value = in.value(property);
                if (slot_of[p] < kSlots) out.columns[slot_of[p]].push_back(value);
            }
        }
        in.endRow();
        out.rows.push_back(uint32_t(in.rowNumber()));
    }
    toParts("colours", {kRed, kGreen, kBlue}, vertex, places, out);
    toParts("opacities", {kOpacity}, vertex, places, out);
    return out;
}

} // namespace brume::ply
