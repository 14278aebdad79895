/* Times one build of CasADi's generated C and prints its outputs.
 *
 *   harness WEIGHTS STATES REPETITIONS PASSES
 *
 * WEIGHTS: little-endian f32, layer by layer, weights column-major (CasADi's order), then the bias.
 * STATES:  little-endian f32, eight a state: q0[2], w[2], p0[2], u[2]; w is also the velocity of the acceleration.
 * A repetition calls the function PASSES times on every state; the fastest repetition counts.
 *
 * Built with -DWEIGHTS_AS_INPUT=1 when the generated functions take the six weight arrays after their other inputs.
 */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#ifndef WEIGHTS_AS_INPUT
#error "define WEIGHTS_AS_INPUT as 0 or 1"
#endif

typedef long long int casadi_int;
typedef int (*function)(const float **, float **, casadi_int *, float *, int);
typedef int (*work_sizes)(casadi_int *, casadi_int *, casadi_int *, casadi_int *);

int acceleration(const float **, float **, casadi_int *, float *, int);
int acceleration_work(casadi_int *, casadi_int *, casadi_int *, casadi_int *);
int residual_jacobian(const float **, float **, casadi_int *, float *, int);
int residual_jacobian_work(casadi_int *, casadi_int *, casadi_int *, casadi_int *);

enum { STATE = 8, LAYERS = 3, MAX_ARGUMENTS = 4 + 2 * LAYERS };
static const int SIZES[LAYERS + 1] = {3, 32, 32, 4};

/* One function with its work space, inputs (offsets into a state) and outputs. */
struct kernel {
    function call;
    int inputs;
    int offsets[4];
    const float **arguments;
    float **results;
    casadi_int *integers;
    float *reals;
    float outputs[6];
};

static void *allocate(size_t count, size_t size) {
    void *memory = calloc(count + 1, size);
    if (!memory) {
        fputs("harness: out of memory\n", stderr);
        exit(1);
    }
    return memory;
}

static float *read_floats(const char *path, size_t *count) {
    FILE *file = fopen(path, "rb");
    if (!file || fseek(file, 0, SEEK_END)) {
        perror(path);
        exit(2);
    }
    *count = (size_t)ftell(file) / sizeof(float);
    rewind(file);
    float *values = allocate(*count, sizeof(float));
    if (fread(values, sizeof(float), *count, file) != *count) {
        perror(path);
        exit(2);
    }
    fclose(file);
    return values;
}

static void bind_weights(const float **arguments, const float *weights) {
    for (int layer = 0; layer < LAYERS; ++layer) {
        arguments[2 * layer] = weights;
        weights += SIZES[layer] * SIZES[layer + 1];
        arguments[2 * layer + 1] = weights;
        weights += SIZES[layer + 1];
    }
}

static void prepare(struct kernel *kernel, work_sizes work, const float *weights) {
    casadi_int arguments, results, integers, reals;
    work(&arguments, &results, &integers, &reals);
    kernel->arguments = allocate((size_t)arguments + MAX_ARGUMENTS, sizeof(float *));
    kernel->results = allocate((size_t)results + 2, sizeof(float *));
    kernel->integers = allocate((size_t)integers, sizeof(casadi_int));
    kernel->reals = allocate((size_t)reals, sizeof(float));
    kernel->results[0] = kernel->outputs;
    kernel->results[1] = kernel->outputs + 2;
    if (WEIGHTS_AS_INPUT) bind_weights(kernel->arguments + kernel->inputs, weights);
}

static inline void evaluate(struct kernel *kernel, const float *state) {
    for (int i = 0; i < kernel->inputs; ++i) kernel->arguments[i] = state + kernel->offsets[i];
    kernel->call(kernel->arguments, kernel->results, kernel->integers, kernel->reals, 0);
}

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* The checksum is printed, so that no call can be left out. */
static double fastest_ns(struct kernel *kernel, const float *states, size_t count, int repetitions, int passes, double *checksum) {
    double best = 1e300;
    for (int repetition = 0; repetition < repetitions; ++repetition) {
        double start = seconds();
        for (int pass = 0; pass < passes; ++pass)
            for (size_t i = 0; i < count; ++i) {
                evaluate(kernel, states + i * STATE);
                *checksum += (double)(kernel->outputs[0] + kernel->outputs[1]);
            }
        double elapsed = seconds() - start;
        if (elapsed < best) best = elapsed;
    }
    return 1e9 * best / ((double)passes * (double)count);
}

/* Prints `indices` of the outputs at every state, as a list of lists. */
static void print_outputs(const char *key, struct kernel *kernel, const float *states, size_t count, const int *indices, int width) {
    printf(", \"%s\": [", key);
    for (size_t i = 0; i < count; ++i) {
        evaluate(kernel, states + i * STATE);
        for (int j = 0; j < width; ++j)
            printf("%s%.9g", j ? ", " : i ? "], [" : "[", (double)kernel->outputs[indices[j]]);
    }
    printf("]]");
}

int main(int argc, char **argv) {
    if (argc != 5) {
        fputs("usage: harness WEIGHTS STATES REPETITIONS PASSES\n", stderr);
        return 2;
    }
    size_t weight_count, count;
    const float *weights = read_floats(argv[1], &weight_count);
    const float *states = read_floats(argv[2], &count);
    int repetitions = atoi(argv[3]), passes = atoi(argv[4]);
    count /= STATE;

    struct kernel acc = {.call = acceleration, .inputs = 3, .offsets = {0, 2, 6}};
    struct kernel del = {.call = residual_jacobian, .inputs = 4, .offsets = {0, 2, 4, 6}};
    prepare(&acc, acceleration_work, weights);
    prepare(&del, residual_jacobian_work, weights);

    double checksum = 0;
    double acceleration_ns = fastest_ns(&acc, states, count, repetitions, passes, &checksum);
    double residual_jacobian_ns = fastest_ns(&del, states, count, repetitions, passes, &checksum);
    printf("{\"acceleration_ns\": %.3f, \"residual_jacobian_ns\": %.3f, \"checksum\": %.9g", acceleration_ns, residual_jacobian_ns, checksum);
    print_outputs("acceleration", &acc, states, count, (const int[]){0, 1}, 2);
    print_outputs("residual", &del, states, count, (const int[]){0, 1}, 2);
    /* CasADi's matrices are column-major, the printed ones row-major. */
    print_outputs("jacobian", &del, states, count, (const int[]){2, 4, 3, 5}, 4);
    puts("}");
    return 0;
}
