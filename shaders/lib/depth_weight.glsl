// How far a filter counts a neighbour whose depth differs: 1 where it lies on the same plane, 0 from a difference of
// push.band.falloff on. Include after `push.band`.

// The change of depth from one pixel to the next, by the nearer of two neighbours. Steeper ones count as edges.
float slopeOf(float before, float own, float after) {
    const float a = own - before, b = after - own, least = abs(a) < abs(b) ? a : b;
    return abs(least) < push.band.falloff ? least : 0;
}

// off: how far the neighbour lies from where the slope leads.
float depthWeight(float off) { return max(1 - abs(off) / push.band.falloff, 0); }
