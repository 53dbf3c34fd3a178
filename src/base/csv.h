/* csv - tables in CSV files: a header line and rows of cells. Faults name file, line and id.
 *
 * Fields may be quoted and then end on the same line. Lines end with LF or CRLF. A byte order mark, empty lines and
 * lines that start with '#' are skipped.
 *
 * Ids may be what a spreadsheet takes for a formula: =1+1, or -a. They are written with an apostrophe in front, which
 * reading takes away: one of those in front of such a text. So every id that can be read is read back as it was. */
#ifndef HIFDM_CSV_H
#define HIFDM_CSV_H

#include <hifdm/status.h>
#include <stdbool.h>
#include <stdio.h>

#define HF_CSV_UNKNOWN_MAX 16

/* Header and cells point into the text, which reading cuts up in place. */
typedef struct {
    const char *path;      /* borrowed */
    hf_messages *messages; /* borrowed */
    int n_column, n_row, header_line;
    char **header; /* [n_column] */
    char **cell;   /* [n_row][n_column] */
    int *line;     /* [n_row] line number in the file */
    int n_fault;
    int n_comma;             /* numbers with decimal commas: the first is a fault of its own, the others are counted */
    const char *const *ours; /* columns that our exports write and this reader does not need, up to NULL; or NULL */
    bool names_are_ids;      /* of cables, say: column x_mm is no length x_m in another unit */
    bool has_doubles;        /* ids stand twice: what names others may be a consequence */
    int n_unknown;           /* names that are nothing in a table with doubles, each told once */
    const char *unknown[HF_CSV_UNKNOWN_MAX];
    char *text;
    int row_capacity;
} hf_csv;

/* HF_OK; HF_BAD_CASE with all faults (no file, uneven rows, no rows, more than column_max columns); HF_NO_MEMORY. Free
 * the table in any case. */
hf_status hf_csv_read(const char *path, int column_max, hf_csv *table, hf_messages *messages);
void hf_csv_free(hf_csv *table);

char *hf_csv_cell(const hf_csv *table, int row, int column);

/* Report one fault at a line, about an id unless that is NULL. Beyond HF_FAULT_MAX of a file they are counted. */
void hf_csv_fault(hf_csv *table, int line, const char *id, const char *what, const char *detail);

/* That `id` names something of `of` which is not there. When ids of that table stand twice one of those may be the
 * misspelt one: then each name is told once, whatever names it. */
void hf_csv_fault_unknown(hf_csv *table, int line, const char *id, const char *what, const char *name,
                          const hf_csv *of);

/* HF_BAD_CASE when there were faults; a last message counts those that were not spelled out. */
hf_status hf_csv_close_faults(hf_csv *table);

/* Where the column of this name stands, or -1. */
int hf_csv_column(const hf_csv *table, const char *name);

/* Where each known column stands (-1 = absent); the first n_required must be there. Unknown ones are warned about, but
 * for table->ours. A column x_m may be x_mm, x_cm, x_in or x_ft instead; all that are required are in one unit. */
hf_status hf_csv_find_columns(hf_csv *table, const char *const *names, int n_name, int n_required, int *where);

/* The cell as a finite number, in metres where its column is in another unit than its `name`: of x_mm and x_cm the
 * double nearest to the decimal number. NaN after a fault, which calls the column by its name. */
double hf_csv_number(hf_csv *table, int row, int column, const char *id, const char *name);

/* The cell as one of some words, in letters of any case; 0 after a fault. */
int hf_csv_word(hf_csv *table, int row, int column, const char *id, const char *const *words, int n_word);

typedef struct {
    const char *id;
    int row;
} hf_csv_named;

/* Sorted ids of a table (caller frees), or NULL without memory; empty, duplicate and overlong (255 bytes) ids are
 * faults, and duplicate ones set has_doubles. */
hf_csv_named *hf_csv_index(hf_csv *table, int column);

/* The same of ids from elsewhere [n], without faults. */
hf_csv_named *hf_csv_index_of(int n, const char *const *id);

/* The row of an id, or -1. */
int hf_csv_row_of(const hf_csv_named *index, int n_row, const char *id);

/* The row of `of`, with its index, that a cell names; 0 after a fault, that `what` has no such id: a sentence up to the
 * name. */
int hf_csv_reference(hf_csv *table, int row, int column, const char *id, const char *what, const hf_csv *of,
                     const hf_csv_named *index);

/* Texts [n] that point into tables. */
typedef struct {
    const char **text;
    int n;
} hf_csv_texts;

/* Moves all texts of the lists into one block, which the caller frees; NULL without memory, and nothing has changed. */
char *hf_csv_keep(int n_list, const hf_csv_texts *list);

/* An id as a CSV field: quoted when it holds a comma, semicolon, quote, tab or end of line, blanks at its ends or a
 * leading '#'; with an apostrophe in front when a spreadsheet would run it. */
void hf_csv_write_id(const char *id, FILE *file);

#endif
