/* main - reads the command line, runs the command, and returns the exit status. The file cmd_NAME.c holds the command
 * NAME.
 *
 *     command line -> options -> a copy of the program, if the command reads results -> libraries -> command
 *                  -> messages -> standard output is closed -> exit status */
#include "app/output.h"
#include "app/reader.h"

#include "base/file_io.h"
#include "base/signals.h"
#include "out/print.h"
#include "out/words.h"
#include <hifdm/batch.h>
#include <hifdm/store.h>

#include <errno.h>
#include <gsl/gsl_errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static bool is_ending;

/* Replaces the exit status of a library that ends the program. libgomp calls exit(1) with a message if it gets no
 * memory or no thread. HDF5 may call exit(-1) during its set-up. But exit status 1 means that two files differ. No more
 * is lost than when the program is killed. */
static void keep_exit_status(void)
{
    static const char words[] = "error: a library gave up, see above; free memory or processes (ulimit -v, -u), or use "
                                "fewer --threads; the same command goes on\n";
    if (is_ending) return;
    hf_file_io_write(STDERR_FILENO, words, sizeof words - 1);
    _exit(hf_status_exit_code(HF_NO_MEMORY));
}

/* Prints a message at once: a warning about the case comes before hours of computation. On a terminal, it replaces the
 * line of the progress. */
static void print_message(const char *line)
{
    size_t n = strcspn(line, "\n") + 1, word = strcspn(line, ":\n");
    if (isatty(STDERR_FILENO)) hf_output_write(STDERR_FILENO, HF_OUTPUT_CLEAR_LINE, strlen(HF_OUTPUT_CLEAR_LINE));
    if (hf_output_has_colour(STDERR_FILENO)) {
        const char *colour = !strncmp(line, "error:", 6) ? HF_PRINT_RED : HF_PRINT_YELLOW;
        hf_output_write(STDERR_FILENO, colour, strlen(colour));
        hf_output_write(STDERR_FILENO, line, word);
        hf_output_write(STDERR_FILENO, HF_PRINT_PLAIN, strlen(HF_PRINT_PLAIN));
        line += word;
        n -= word;
    }
    hf_output_write(STDERR_FILENO, line, n);
}

/* Prints the messages so far, and from now on each one at once. */
static void print_from_now(hf_messages *messages)
{
    for (const char *line = messages->text; line && *line; line += strcspn(line, "\n") + 1)
        print_message(line);
    messages->report = print_message;
}

/* Prints the words of these messages, and of a status about the net, that `hifdm explain` can explain. */
static void say_where_to_read_on(const char *lines, hf_status status)
{
    int n = 0;
    for (int i = 0; i < hf_word_count(); i++) {
        const hf_word w = hf_word_at(i);
        bool is_status = status != HF_OK && (hf_status_exit_code(status) == 3 || hf_status_exit_code(status) == 4) &&
                         !strcmp(w.kind, "status") && !strcmp(w.word, hf_status_word(status));
        if (!is_status && !hf_word_is_in(i, lines)) continue;
        fprintf(stderr, "%s%s", n++ ? ", " : "`hifdm explain WORD` explains: ", w.word);
    }
    if (n) fputc('\n', stderr);
}

/* Ends the messages. They need memory, too: if it ran out, an error is printed nevertheless. */
static void say(const hf_messages *messages, hf_status status)
{
    if (messages->text && isatty(STDERR_FILENO)) say_where_to_read_on(messages->text, status);
    if (hf_status_exit_code(status) == hf_status_exit_code(HF_NO_MEMORY) &&
        (!messages->text || !strstr(messages->text, "error: ")))
        fprintf(stderr, "error: %s\n", hf_status_text(status));
}

/* Closes the output. A file server may report a full disk only at the close. A closed standard output is no error
 * unless something was written to it. Returns HF_OK, HF_IO or HF_INTERRUPTED. */
static hf_status close_output(FILE *output)
{
    bool failed = fflush(output) != 0 || ferror(output);
    if (output != stdout) fclose(output);
    if (failed && *hf_signals_request()) return HF_INTERRUPTED;
    return failed || (fclose(stdout) != 0 && errno != EBADF) ? HF_IO : HF_OK;
}

int main(int argc, char **argv)
{
    hf_options options;
    hf_messages messages = {0};
    hf_status status = hf_options_parse(argc, argv, hf_command_table, &options, &messages);
    bool uses_threads = status == HF_OK && options.command->uses_threads;
    int exit_status;
    signal(SIGCHLD, SIG_DFL); /* if a launcher ignores it, the end of a child cannot be read */
    if (status == HF_OK && options.command->reads_results && hf_reader_watch(&options, &exit_status, &messages)) {
        print_from_now(&messages);
        say(&messages, status);
        hf_messages_free(&messages);
        hf_options_free(&options);
        return exit_status;
    }
    if (uses_threads) hf_batch_wait_quietly(argv); /* may start the program again, so it comes before the libraries */
    print_from_now(&messages);
    signal(SIGXFSZ, SIG_IGN); /* writing beyond the limit on file size then fails with an error */
    gsl_set_error_handler_off();
    atexit(keep_exit_status);
    if (!hf_store_quiet() && status == HF_OK) status = HF_NO_MEMORY;
    atexit(keep_exit_status); /* registered again as the last one, so that it is called first */
    FILE *output = hf_output_stream();
    if (status == HF_OK) status = options.command->run(&options, output, &messages);
    hf_options_free(&options);
    say(&messages, status);
    hf_messages_free(&messages);
    is_ending = true;
    hf_status written = close_output(output);
    if (written == HF_IO) fputs("error: cannot write to standard output\n", stderr);
    if (status == HF_OK || status == HF_DIFFERENT) status = written == HF_OK ? status : written;
    return hf_status_exit_code(status);
}
