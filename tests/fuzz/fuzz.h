/* fuzz - what the harnesses share: files in memory, limits on what an input may cost, and what must hold for every
 * answer. A harness is fuzz_NAME.c with LLVMFuzzerTestOneInput (libFuzzer); its inputs are in corpus/NAME. tests/fuzz/
 * run.sh runs them. */
#pragma once

#include <hifdm/status.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

enum { FUZZ_PATH_SIZE = 256 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* The path of a file in the folder of this process, which is in memory (TMPDIR, else /dev/shm) and removed at exit. */
void fuzz_path(const char *name, char path[FUZZ_PATH_SIZE]);

/* Write a file there. */
void fuzz_write(const char *name, const void *data, size_t size);
void fuzz_write_text(const char *name, const char *text);

/* Where the second of two tables in one input begins, behind a line "%%"; `size` when there is no such line.
 * *first_size: length of the first. */
size_t fuzz_split(const uint8_t *data, size_t size, size_t *first_size);

/* True: hf_config_load reads a case once and gives the same settings each time, for harnesses whose case stays; reading
 * it takes five times as long as all the rest. */
extern bool fuzz_keeps_case;

/* What must hold of every answer: a failure has words, success has none, and the words are lines of UTF-8 that command
 * no terminal. Memory must not have run out: inputs that need much of it are to be refused before. Frees the messages.
 */
void fuzz_judge(hf_status status, hf_messages *messages);

/* Ends the process as a crash would, so that libFuzzer keeps the input. */
#define FUZZ_REQUIRE(condition) ((condition) ? (void)0 : fuzz_fail(#condition, __FILE__, __LINE__))
void fuzz_fail(const char *condition, const char *file, int line) __attribute__((noreturn));
