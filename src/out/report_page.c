#include "out/report_page.h"

#include "base/text.h"

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
    char shown[4096];
    fputs(hf_report_page_head, f);
    hf_text_escape(title, shown, sizeof shown);
    fputs("</style>\n<title>", f);
    write_html(shown, f);
    fputs("</title>\n", f);
    fputs(hf_report_page_body, f);
    write(context, f);
    fputs("</script>\n<script>\n", f);
    fputs(hf_report_page_script, f);
    fputs("</script>\n</body>\n</html>\n", f);
}
