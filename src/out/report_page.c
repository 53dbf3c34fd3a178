/* Writes a page: style, title, body, data as JSON, script. */
#include "out/report.h"

#include "base/text.h"
#include <string.h>

/* Writes text of any origin. Hidden characters become visible, and nothing becomes markup. */
static void write_text(const char *text, FILE *f)
{
    char shown[4096];
    hf_text_escape(text, shown, sizeof shown);
    for (const char *p = shown; *p; p++) {
        if (*p == '&' || *p == '<' || *p == '>')
            fprintf(f, "&#%d;", *p);
        else
            fputc(*p, f);
    }
}

void hf_report_page_write(const void *page, FILE *f)
{
    const hf_report_page *p = page;
    const char *end_of_main = strstr(hf_report_page_body, "</main>");
    fputs(hf_report_page_head, f);
    fputs("</style>\n<title>", f);
    write_text(p->title, f);
    fputs("</title>\n", f);
    fwrite(hf_report_page_body, 1, (size_t)(end_of_main - hf_report_page_body), f);
    if (p->answer) {
        fputs("  <noscript><p>", f);
        write_text(p->answer, f);
        fputs("</p></noscript>\n", f);
    }
    fputs(end_of_main, f);
    p->write_data(p->context, f);
    fputs("</script>\n<script>\n", f);
    fputs(hf_report_page_script, f);
    fputs("</script>\n</body>\n</html>\n", f);
}
