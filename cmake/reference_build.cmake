# cmake -DLIBRARY=FILE -DOUTPUT=FILE -P: writes the hash of the library to a source file.
file(SHA256 ${LIBRARY} hash)
string(SUBSTRING ${hash} 0 16 hash)
file(WRITE ${OUTPUT} "#include \"tests/gpu/reference_build.h\"\n\nconst uint64_t brume::test::kReferenceBuild = 0x${hash};\n")
