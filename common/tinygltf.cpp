#include <fstream> // which tinygltf lacks without its own files

#define TINYGLTF_IMPLEMENTATION
#include "common/tinygltf.h"
