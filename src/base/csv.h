/* csv - tables in CSV files: a header line and rows of cells. Error messages contain file, line and id.
 *
 * Fields may be quoted; a quoted field ends on the line where it begins. Lines end with LF or CRLF. The reader skips a
 * byte order mark, empty lines and lines that start with '#'.
 *
 * A spreadsheet can take an id such as =1+1 or -a for a formula. Such ids are written with an apostrophe in
 * front, and the reader removes one apostrophe in front of such a text. So every id that can be read is also
 * read back unchanged. */
#pragma once

#include <hifdm/status.h>
#include <stdbool.h>
#include <stdio.h>

#define HF_CSV_UNKNOWN_MAX 16

/* A table. Header and cells point into `text`, which the reader splits in place. */
typedef struct {
    const char *path;      /* borrowed */
    hf_messages *messages; /* borrowed */
    int n_column, n_row, header_line;
    char **header; /* [n_column] */
    char **cell;   /* [n_row][n_column] */
    int *line;     /* [n_row], line number in the file */
    int n_fault;
    int n_comma;             /* numbers with decimal commas; only the first is reported in full */
    const char *const *ours; /* columns of our exports that the reader ignores silently, up to a NULL; or NULL */
    bool names_are_ids;      /* column names are ids (of cables, for example): x_mm is then not x_m in another unit */
    bool has_doubles;        /* an id occurs twice: unknown names elsewhere may be a consequence */
    int n_unknown;           /* ids that another table with duplicate ids lacks; each is reported once */
    const char *unknown[HF_CSV_UNKNOWN_MAX];
    struct hf_csv_id *own, *known; /* sorted ids: of the rows; of the things that the table may refer to */
    int n_known;
    char *text;
    int row_capacity;
} hf_csv;

/* Reads a table of at most column_max columns. Returns HF_OK. Returns HF_BAD_CASE after reporting the faults: no such
 * file, uneven rows, no rows, too many columns, text that is not UTF-8. Returns HF_IO if the file cannot be read, and
 * HF_NO_MEMORY if memory runs out. The caller frees the table in every case. */
hf_status hf_csv_read(const char *path, int column_max, hf_csv *table, hf_messages *messages);
void hf_csv_free(hf_csv *table);

char *hf_csv_cell(const hf_csv *table, int row, int column);

/* Reports one fault at a line. `id` is the id of the row, or NULL. Faults beyond HF_FAULT_MAX of a file
 * are only counted. */
void hf_csv_fault(hf_csv *table, int line, const char *id, const char *what, const char *detail);

/* Returns HF_BAD_CASE if there were faults, else HF_OK. Reports how many faults were only counted. */
hf_status hf_csv_close_faults(hf_csv *table);

/* Reports that there is no memory for the table. Returns HF_NO_MEMORY. */
hf_status hf_csv_no_memory(const hf_csv *table);

/* Returns the index of the column with this name, or -1. */
int hf_csv_column(const hf_csv *table, const char *name);

/* Writes the column index of each of the n_name names into where[n_name], -1 for an absent column. The first
 * n_required columns must exist. Warns about unknown columns unless `ours` of the table lists them. Instead of a
 * column x_m the table may have x_mm, x_cm, x_in or x_ft; all required lengths must have the same unit. Returns
 * HF_OK or HF_BAD_CASE. */
hf_status hf_csv_find_columns(hf_csv *table, const char *const *names, int n_name, int n_required, int *where);

/* Returns the cell as a finite number. If the column has another unit of length than `name`, the number is converted to
 * metres. For mm and cm the result is the double nearest to the decimal number. Returns NaN after reporting a fault,
 * which contains the name of the column as in the file. */
double hf_csv_number(hf_csv *table, int row, int column, const char *id, const char *name);

/* Returns the index of the cell among n_word words, in upper or lower case; 0 after reporting a fault. */
int hf_csv_word(hf_csv *table, int row, int column, const char *id, const char *const *words, int n_word);

/* Sorts the ids of a column. Reports ids that are empty, duplicate or longer than 255 bytes. Duplicate ids set
 * has_doubles. Returns HF_OK, or HF_NO_MEMORY with an error. */
hf_status hf_csv_index(hf_csv *table, int column);

/* Returns the row of table `of` to which a cell refers. hf_csv_index has sorted the ids of `of`. Reports a fault and
 * returns 0 if there is no such id. `what` is the start of the message; the name follows it. */
int hf_csv_reference(hf_csv *table, int row, int column, const char *id, const char *what, const hf_csv *of);

/* hf_csv_know sorts other ids to which the table refers, id[n]. Returns HF_OK, or HF_NO_MEMORY with an error.
 * hf_csv_find_known then returns the index of an id among them, or -1. */
hf_status hf_csv_know(hf_csv *table, int n, const char *const *id);
int hf_csv_find_known(const hf_csv *table, const char *id);

/* n texts that point into tables. */
typedef struct {
    const char **text;
    int n;
} hf_csv_texts;

/* Moves all texts of the lists into one block, and lets the lists point there. The caller frees the block. Returns NULL
 * if memory runs out; the lists are then unchanged. */
char *hf_csv_keep(int n_list, const hf_csv_texts *list);

/* Writes an id as a CSV field. The field is quoted if the id contains a comma, a semicolon, a quote, a tab or an end
 * of line, or has blanks at its ends or a leading '#'. It begins with an apostrophe if a spreadsheet would take it
 * for a formula. */
void hf_csv_write_id(const char *id, FILE *file);
