// Workgroups in another order. A CPU driver gives each of its threads one run of neighbouring workgroups. Tiles of the
// dense part of a medium would be one thread's, while others are done.

// This workgroup's y and z, such that those that follow one another lie far apart. Each is some workgroup's.
uvec2 spreadRows() {
    const uint rows = gl_NumWorkGroups.y * gl_NumWorkGroups.z;
    const uint step = rows % 61 != 0 ? 61 : 67; // primes: no row is left out
    const uint row = (gl_WorkGroupID.z * gl_NumWorkGroups.y + gl_WorkGroupID.y) % rows * step % rows;
    return uvec2(row % gl_NumWorkGroups.y, row / gl_NumWorkGroups.y);
}
