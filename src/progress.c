#include "progress.h"

#include "print.h"

#include <unistd.h>

#define REFRESH_S 0.1

hf_progress hf_progress_on(FILE *file, int quiet)
{
    return (hf_progress){.file = !quiet && isatty(fileno(file)) ? file : NULL};
}

void hf_progress_show(void *progress, const hf_run_progress *now)
{
    hf_progress *p = progress;
    char left[32];
    if (now->phase != HF_RUN_EVOLVE) p->last_s = -1;
    if (!p->file || now->phase != HF_RUN_EVOLVE || now->elapsed_s - p->last_s < REFRESH_S) return;
    p->last_s = now->elapsed_s;
    p->is_shown = 1;
    hf_print_duration(now->elapsed_s * (now->generations - now->generation) / now->generation, left, sizeof left);
    fprintf(p->file, "\r\033[Kgeneration %d/%d  best psi %.4f mm  %.0f evaluations/s  at most %s left", now->generation,
            now->generations, now->best_psi_m * 1e3, (double)now->evaluations / now->elapsed_s, left);
    fflush(p->file);
}

void hf_progress_end(hf_progress *p)
{
    if (!p->is_shown) return;
    fputs("\r\033[K", p->file);
    fflush(p->file);
    p->is_shown = 0;
}
