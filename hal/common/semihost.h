/* semihost.h - calls to the emulator or debugger that runs the core: files on its machine, an exit status. For tests of a board;
 * a product has nobody at the other end. Source: ARM IHI 0100 (semihosting), RISC-V semihosting 0.4. */
#ifndef HAL_SEMIHOST_H
#define HAL_SEMIHOST_H

#include <stdint.h>

#define SEMIHOST_OPEN          0x01u /* {path, mode, length of path}: handle, or -1 */
#define SEMIHOST_WRITE         0x05u /* {handle, bytes, n}: how many were not written */
#define SEMIHOST_READ          0x06u /* {handle, bytes, n}: how many were not read */
#define SEMIHOST_EXIT_EXTENDED 0x20u /* {reason, status} */

#define SEMIHOST_MODE_READ  1u /* "rb" */
#define SEMIHOST_MODE_WRITE 5u /* "wb" */
#define SEMIHOST_EXITED     0x20026u

#if defined(__riscv)
static inline int32_t semihost(uint32_t operation, const uint32_t *block)
{
    register uint32_t a0 __asm("a0") = operation;
    register const uint32_t *a1 __asm("a1") = block;
    /* The three instructions may not be compressed, nor lie in two pages. */
    __asm volatile(".option push\n\t.option norvc\n\t.balign 16\n\t"
                   "slli x0, x0, 0x1f\n\tebreak\n\tsrai x0, x0, 7\n\t.option pop"
                   : "+r"(a0)
                   : "r"(a1)
                   : "memory");
    return (int32_t)a0;
}
#else
static inline int32_t semihost(uint32_t operation, const uint32_t *block)
{
    register uint32_t r0 __asm("r0") = operation;
    register const uint32_t *r1 __asm("r1") = block;
    __asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
    return (int32_t)r0;
}
#endif

#endif
