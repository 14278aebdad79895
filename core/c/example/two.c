/* Two models of different shapes in one program: the traces of both. Each is the example with names of its own. */
#include <stddef.h>

int cart_trace(void);
int arm_trace(void);

int main(void) {
    int failed = cart_trace();
    failed |= arm_trace();
    return failed;
}
