#include "out/report_page.h"

static void write_html(const char *text, FILE *f)
{
    for (; *text; text++) {
        if (*text == '&' || *text == '<' || *text == '>')
            fprintf(f, "&#%d;", *text);
        else
            fputc(*text, f);
    }
}

void hf_report_page_write(const char *title, void (*write)(const void *context, FILE *file), const void *context,
                          FILE *f)
{
    fputs(hf_report_page_head, f);
    fputs("</style>\n<title>", f);
    write_html(title, f);
    fputs("</title>\n", f);
    fputs(hf_report_page_body, f);
    write(context, f);
    fputs("</script>\n<script>\n", f);
    fputs(hf_report_page_script, f);
    fputs("</script>\n</body>\n</html>\n", f);
}
