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

/* What the call returns; with nobody listening the core faults. */
int32_t semihost(uint32_t operation, const uint32_t *block);

#endif
