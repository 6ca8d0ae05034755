// Shadows of objects on a ray: where they begin and end.
vec2 shadows[kMostShadows];
uint shadow_count;

// One more than there is room for is joined with the one to which it has the least gap: what lies between counts as
// shadow.
void addShadow(vec2 range) {
    if (shadow_count < kMostShadows) {
        shadows[shadow_count++] = range;
        return;
    }
    uint best = 0;
    float least = 1e30;
    for (uint i = 0; i < kMostShadows; ++i) {
        const float gap = max(range.x - shadows[i].y, shadows[i].x - range.y);
        if (gap >= least) continue;
        least = gap;
        best = i;
    }
    shadows[best] = vec2(min(shadows[best].x, range.x), max(shadows[best].y, range.y));
}

// Adds a shadow after it is joined with all that it meets, or that are less than `gap` away. If all are added so, none
// meets another, and each place counts once.
void joinShadow(vec2 range, float gap) {
    for (uint i = 0; i < shadow_count;) {
        if (shadows[i].x > range.y + gap || shadows[i].y < range.x - gap) {
            ++i;
            continue;
        }
        range = vec2(min(range.x, shadows[i].x), max(range.y, shadows[i].y));
        shadows[i] = shadows[--shadow_count];
        i = 0; // what is longer now may meet those before
    }
    addShadow(range);
}
