// Every medium method, one line each: BRUME_METHOD(name) stands for the folder server/methods/name, which defines
//   const MethodPlan& brume::methods::name::plan()                               what it is and what it costs
//   (name_plan.cpp) std::unique_ptr<Method> brume::methods::name::make(const MethodContext&)     what it does on the
//   device (name.cpp)
// Included where a table of them is made; the order is the one in which people see them.
BRUME_METHOD(slabs)
BRUME_METHOD(grid)
BRUME_METHOD(sphere)
BRUME_METHOD(tiles)
BRUME_METHOD(isv)
BRUME_METHOD(froxels)
BRUME_METHOD(lit)
BRUME_METHOD(gradients)
BRUME_METHOD(sprites)
BRUME_METHOD(march)
BRUME_METHOD(tetrahedra)
