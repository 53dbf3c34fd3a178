/* read_example - a result file from C, by libhifdm: psi of each shape, and the nodes that are farthest from their
 * target positions after form-finding.
 *
 *     cc -std=c11 tools/read_example.c $(pkg-config --cflags --libs hifdm) -lm -o read_example
 *     ./read_example results/chen2022.h5 */
#include <hifdm/hifdm.h>

#include <math.h>
#include <stdio.h>

#define N_WORST 3

static double deviation_m(const hf_scene *scene, const hf_shape *shape, int node)
{
    const double *is = shape->position_m + 3 * node, *target = scene->position_m + 3 * node;
    return hypot(hypot(is[0] - target[0], is[1] - target[1]), is[2] - target[2]);
}

static hf_status print_result(const char *path, hf_summary *summary, hf_scene *scene, hf_shape *shape,
                              hf_messages *said)
{
    HF_TRY(hf_store_read_summary(path, summary, said));
    printf("%s\n", summary->title);
    printf("psi %.4f mm after form-finding\n", summary->stage[HF_STAGE_FORM].result.psi_m * 1e3);
    if (summary->stage[HF_STAGE_SEARCH].exists)
        printf("psi %.4f mm after the search\n", summary->stage[HF_STAGE_SEARCH].result.psi_m * 1e3);
    if (summary->stage[HF_STAGE_REFINE].exists)
        printf("psi %.4f mm after the refinement\n", summary->stage[HF_STAGE_REFINE].result.psi_m * 1e3);

    HF_TRY(hf_store_read_scene(path, scene, said));
    HF_TRY(hf_store_read_shape(path, HF_STAGE_FORM, shape, said));
    double bound_m = INFINITY;
    for (int k = 0; k < N_WORST; k++) {
        int worst = -1;
        for (int i = 0; i < scene->n_node; i++) {
            double d_m = deviation_m(scene, shape, i);
            if (scene->role[i] != HF_ROLE_INNER || d_m >= bound_m) continue;
            if (worst < 0 || d_m > deviation_m(scene, shape, worst)) worst = i;
        }
        if (worst < 0) break;
        bound_m = deviation_m(scene, shape, worst);
        printf("node %s is off by %.4f mm\n", scene->node_id[worst], bound_m * 1e3);
    }
    return HF_OK;
}

int main(int argc, char **argv)
{
    hf_messages said = {0};
    hf_summary summary = {0};
    hf_scene scene = {0};
    hf_shape shape = {0};
    if (argc != 2) {
        fprintf(stderr, "usage: %s RESULT\n", argv[0]);
        return 2;
    }
    hf_status status = print_result(argv[1], &summary, &scene, &shape, &said);
    if (said.text) fputs(said.text, stderr);
    hf_shape_free(&shape);
    hf_scene_free(&scene);
    hf_summary_free(&summary);
    hf_messages_free(&said);
    return hf_status_exit_code(status);
}
