/* offsetof.h - the prover puts its own in its place, which is no constant; included before every source. */
#undef __builtin_offsetof
