// What the stages of sprites have in common.
layout(push_constant, scalar) uniform SpritePush {
    float size; // half a sprite's side, in radii of its ball
    float lit;  // 1: particles shadow each other; 0: they do not
} push;
