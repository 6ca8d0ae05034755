// Walks along a line through a mesh of tetrahedra, from neighbour to neighbour: in the right order on every line, with
// nothing sorted. Which face a line leaves by follows from the sides on which it passes the edges. Two tetrahedra
// compute the same side for an edge that they share, so no line is lost between them (Platis and Theoharis 2003).
// Include after these buffers are declared:
//   Tetrahedron cells[]
//   TetrahedraFace faces[]            of the outside
//   ObjectNode face_nodes[]           their tree
#include "shaders/blocks/particles.glsl"

const float kEndless = 1e30; // m

struct Line {
    vec3 origin, dir; // a place is origin + t dir; `dir` is unit
    vec3 inverse;     // 1 / dir
    vec3 x, y;        // span the plane across the line: cross(x, y) = -dir
};

Line lineOf(vec3 origin, vec3 dir) {
    const vec3 helper = abs(dir.y) < 0.7 ? vec3(0, 1, 0) : vec3(1, 0, 0), x = normalize(cross(dir, helper));
    return Line(origin, dir, 1 / mix(dir, vec3(1e-12), lessThan(abs(dir), vec3(1e-12))), x, cross(x, dir));
}

// A corner as the line sees it.
struct Corner {
    uint index;
    vec2 at;     // m across the line
    float t;     // m along it
    float sigma; // 1/m
    vec3 albedo;
};

Corner cornerOf(Line line, uint index) {
    const Particle particle = particles[index];
    const vec3 to = particle.centre - line.origin;
    precise const vec2 at = vec2(dot(line.x, to), dot(line.y, to));
    return Corner(index, at, dot(line.dir, to), particle.sigma_t, particle.albedo);
}

// The upper 12 bits of a float's 24: products of such are exact (Dekker 1971).
float headOf(float x) {
    precise const float large = 4097 * x, head = large - (large - x);
    return head;
}

// What the product of two floats loses when it is rounded. fma() may round twice.
float lostOf(float a, float b, float product) {
    const float a_head = headOf(a), b_head = headOf(b);
    precise const float a_tail = a - a_head, b_tail = b - b_head;
    precise const float lost =
        ((a_head * b_head - product) + (a_head * b_tail + a_tail * b_head)) + a_tail * b_tail;
    return lost;
}

// On which side the line passes the edge from a to b: 0 if it meets it. Of b and a it is the same number, negated. Its
// sign is right, however near they are.
float sideOf(Corner a, Corner b) {
    precise const float first = a.at.x * b.at.y, second = a.at.y * b.at.x;
    precise float side = first - second;
    if (abs(side) <= 2.4e-7 * (abs(first) + abs(second))) {
        precise const float lost = lostOf(a.at.x, b.at.y, first) - lostOf(a.at.y, b.at.x, second);
        side += lost;
    }
    return side;
}

// True: the line passes the edge on its left. A line that meets the edge counts as moved aside, by less than any
// number along y, and by far less along x. So every line lies on one side of each edge (Edelsbrunner and Muecke 1990).
bool isLeft(float side, Corner a, Corner b) {
    return side != 0 ? side > 0 : a.at.x != b.at.x ? a.at.x < b.at.x : a.at.y > b.at.y;
}

// Where a line is: on a face that it goes through.
struct Walk {
    Corner a, b, c;   // of the face, counterclockwise for who looks along the line
    float ab, bc, ca; // sideOf() its edges, >= 0
    uint cell;        // the tetrahedron ahead; kNoTetrahedron: none
    bool placed;      // True: the line has met a face that is not seen edge-on
    // Where it met the last such face.
    float t;
    float sigma;
    vec3 albedo;
};

// Largest coordinate of a corner, m: what its places are rounded by is a part of it.
float sizeOf(Corner corner) { return max(max(abs(corner.at.x), abs(corner.at.y)), abs(corner.t)); }

// Sets t, sigma and albedo. A face that is seen edge-on, as far as roundings tell, has no such place. What is in it, a
// line meets on the faces around it, too.
void arrive(inout Walk walk) {
    const vec3 weights = max(vec3(walk.bc, walk.ca, walk.ab), 0);
    const float sum = weights.x + weights.y + weights.z; // twice the area that is seen
    const float edges = distance(walk.a.at, walk.b.at) + distance(walk.b.at, walk.c.at);
    const float rounding = 4e-7 * max(max(sizeOf(walk.a), sizeOf(walk.b)), sizeOf(walk.c));
    if (!(sum > rounding * edges)) return;
    const vec3 part = weights / sum;
    walk.placed = true;
    walk.t = max(walk.t, dot(part, vec3(walk.a.t, walk.b.t, walk.c.t)));
    walk.sigma = dot(part, vec3(walk.a.sigma, walk.b.sigma, walk.c.sigma));
    if (!kOneAlbedo) walk.albedo = mat3(walk.a.albedo, walk.b.albedo, walk.c.albedo) * part;
}

// Goes through the tetrahedron ahead, to the face by which the line leaves it. If the line was placed before, it is in
// the tetrahedron from the t of then to that of now.
void passTetrahedron(inout Walk walk, Line line) {
    const Tetrahedron cell = cells[walk.cell];
    const uvec4 corners = cell.corners;
    const Corner d = cornerOf(line, corners.x ^ corners.y ^ corners.z ^ corners.w ^ walk.a.index ^ walk.b.index ^
                                        walk.c.index);
    const float ad = sideOf(walk.a, d), bd = sideOf(walk.b, d), cd = sideOf(walk.c, d);
    uint left; // the corner that the face behind lacks
    const bool left_of_bd = isLeft(bd, walk.b, d);
    if (left_of_bd && !isLeft(ad, walk.a, d)) {
        left = walk.c.index;
        walk.c = d;
        walk.bc = bd;
        walk.ca = -ad;
    } else if (!left_of_bd && isLeft(cd, walk.c, d)) {
        left = walk.a.index;
        walk.a = d;
        walk.ca = cd;
        walk.ab = -bd;
    } else {
        left = walk.b.index;
        walk.b = d;
        walk.ab = ad;
        walk.bc = -cd;
    }
    const bvec4 is_left = equal(corners, uvec4(left));
    walk.cell = is_left.x   ? cell.neighbours.x
                : is_left.y ? cell.neighbours.y
                : is_left.z ? cell.neighbours.z
                            : cell.neighbours.w;
    arrive(walk);
}

// t of the begin and the end of the line in a node's box, which is larger by what is rounded: a line may lie in one of
// its faces.
vec2 boxOn(ObjectNode node, Line line) {
    const vec3 rounding = 2e-6 * (abs(node.lo) + abs(node.hi) + abs(line.origin));
    const vec3 a = (node.lo - rounding - line.origin) * line.inverse;
    const vec3 b = (node.hi + rounding - line.origin) * line.inverse;
    const vec3 t0 = min(a, b), t1 = max(a, b);
    return vec2(max(t0.x, max(t0.y, t0.z)), min(t1.x, min(t1.y, t1.z)));
}

// Places `walk` on a face, before the tetrahedron `cell`. False: the line does not go through it.
bool meetFace(out Walk walk, Line line, uvec3 corners, uint cell) {
    walk.a = cornerOf(line, corners.x);
    walk.b = cornerOf(line, corners.y);
    walk.c = cornerOf(line, corners.z);
    walk.ab = sideOf(walk.a, walk.b);
    walk.bc = sideOf(walk.b, walk.c);
    walk.ca = sideOf(walk.c, walk.a);
    walk.cell = cell;
    walk.placed = false;
    walk.t = -kEndless;
    walk.sigma = 0;
    walk.albedo = vec3(1);
    if (!isLeft(walk.ab, walk.a, walk.b) || !isLeft(walk.bc, walk.b, walk.c) || !isLeft(walk.ca, walk.c, walk.a))
        return false;
    arrive(walk);
    return true;
}

// A place where the line enters the mesh. No two are equal: those at the same t go by the number of their face.
struct Entry {
    float t;
    uint face; // index in `faces`
};
bool isBefore(Entry a, Entry b) { return a.t < b.t || (a.t == b.t && a.face < b.face); }
const uint kAnyFace = 0xffffffffu;

// Finds the first entry that is after `after`, and no further than `to`; if `last`, the last one. Sets `after` to it.
// False: there is none.
bool enterMesh(inout Walk walk, Line line, uint count, inout Entry after, float to, bool last) {
    Entry found = Entry(to, kAnyFace);
    bool any = false;
    [[dont_unroll]] for (uint i = 0; i < 2 * count - 1;) {
        const ObjectNode node = face_nodes[i];
        const vec2 range = boxOn(node, line);
        const bool met = max(range.x, after.t) <= min(range.y, found.t);
        i = met ? i + 1 : node.next;
        if (!met || node.object == kInnerNode) continue;
        const TetrahedraFace face = faces[node.object];
        Walk here;
        if (!meetFace(here, line, face.corners, face.cell)) continue;
        const float middle = (here.a.t + here.b.t + here.c.t) / 3;
        const Entry entry = Entry(here.placed ? here.t : middle, node.object);
        if (!isBefore(after, entry) || !isBefore(entry, found)) continue;
        walk = here;
        any = true;
        if (last) after = entry;
        else found = entry;
    }
    if (any && !last) after = found;
    return any;
}

// What a place on the line is rounded by, at most, m.
float roundingAt(Line line, float t) {
    return 2e-6 * (abs(line.origin.x) + abs(line.origin.y) + abs(line.origin.z) + abs(t));
}

// Where the line enters again, after it has left at walk.t what it had entered at `entered`. Pieces of a mesh may
// touch: by roundings one may then begin before the other ends. Each entry is after the last: their number is finite.
bool enterAgain(inout Walk walk, Line line, uint count, inout Entry entered, float to) {
    const float left = walk.t;
    const Entry touches = Entry(left - roundingAt(line, left), 0);
    if (isBefore(entered, touches)) entered = touches;
    if (!enterMesh(walk, line, count, entered, to, false)) return false;
    walk.t = max(walk.t, left);
    return true;
}
